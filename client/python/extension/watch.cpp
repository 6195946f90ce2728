#include "client/python/extension/watch.h"

#include <exception>

#include "client/python/extension/helper.h"

namespace tetstream::python {
namespace {

/// How often whoever waits looks whether there was a signal or progress: Ctrl-C seems
/// immediate.
constexpr std::chrono::milliseconds kLookUp{30};
/// A later deadline is none: clocks cannot represent all of them.
constexpr double kLastDeadline = 9e9;

/// Only the thread that Python began with handles signals. Read and written with the GIL.
unsigned long main_thread = 0;

bool handles_signals() { return PyThread_get_thread_ident() == main_thread; }

}  // namespace

void raise_error(const Status& status) {
  const FailureDetails& details = status.details();
  const py::object error =
      py::module_::import("tetstream._errors")
          .attr("error_of")(static_cast<int>(status.code()), status.message(), status.reason(),
                            py::arg("field") = details.field, py::arg("what") = details.what,
                            py::arg("value") = details.value, py::arg("limit") = details.limit,
                            py::arg("request_id") = details.request_id);
  PyErr_SetObject(py::type::of(error).ptr(), error.ptr());
  throw py::error_already_set();
}

void find_main_thread() {
  main_thread = py::module_::import("threading")
                    .attr("main_thread")()
                    .attr("ident")
                    .cast<unsigned long>();
}

void become_main_thread() { main_thread = PyThread_get_thread_ident(); }

Watch::Watch(py::object progress,
             std::optional<double> deadline,
             const std::stop_source& stop_source)
    : progress_(std::move(progress)),
      outer_(stop_source.get_token(), [own = stop_source_]() mutable { own.request_stop(); }),
      reached_(std::make_shared<std::atomic<double>>(0)) {
  if (!deadline || *deadline > kLastDeadline) return;
  using Clock = std::chrono::system_clock;
  deadline_ = Clock::time_point(
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(*deadline)));
}

void Watch::connect(WorkOptions& options) const {
  options.stop = stop_source_.get_token();
  options.deadline = deadline_;
  if (progress_.is_none()) return;
  options.progress = [reached = reached_](double fraction) {
    double before = reached->load();
    while (before < fraction && !reached->compare_exchange_weak(before, fraction)) {
    }
  };
}

void Watch::run(const std::function<void()>& work) {
  if (progress_.is_none() && !handles_signals()) {
    const py::gil_scoped_release released;
    return work();
  }
  std::optional<py::error_already_set> interruption;
  std::exception_ptr failure;
  {
    const py::gil_scoped_release released;
    const HelperLease helper;
    helper->begin(work);
    while (!helper->is_done_within(kLookUp)) {
      if (interruption) continue;  // it ends soon
      const py::gil_scoped_acquire held;
      interruption = look_up();
      if (interruption) stop();
    }
    failure = helper->failure();
  }
  if (interruption) throw py::error_already_set(*std::move(interruption));
  if (failure) std::rethrow_exception(failure);
}

void Watch::tell_reached() try { tell(reached_->load()); } catch (py::error_already_set&) {
  stop();
  throw;
}

void Watch::finish() { tell(1); }

void Watch::tell(double fraction) {
  if (progress_.is_none() || fraction <= told_) return;
  told_ = fraction;
  progress_(fraction);
}

std::optional<py::error_already_set> Watch::look_up() try {
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  tell(reached_->load());
  return std::nullopt;
} catch (py::error_already_set& raised) {
  return std::move(raised);
}

}  // namespace tetstream::python
