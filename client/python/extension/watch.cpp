#include "client/python/extension/watch.h"

#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

namespace tetstream::python {
namespace {

/// How often whoever waits looks whether there was a signal or progress: Ctrl-C seems
/// immediate.
constexpr std::chrono::milliseconds kLookUp{30};
/// A later deadline is none: clocks cannot represent all of them.
constexpr double kLastDeadline = 9e9;

/// Work on a thread of its own, and when it is over.
class Worker {
 public:
  explicit Worker(const std::function<void()>& work)
      : thread_([this, &work] {
          try {
            work();
          } catch (...) {
            failure_ = std::current_exception();
          }
          const std::lock_guard lock(mutex_);
          done_ = true;
          changed_.notify_all();
        }) {}

  bool is_done_within(std::chrono::milliseconds time) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, time, [&] { return done_; });
  }
  /// What the work threw, if anything; to be asked once it is done.
  std::exception_ptr failure() const { return failure_; }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool done_ = false;
  std::exception_ptr failure_;
  std::jthread thread_;  // last: it uses the others
};

}  // namespace

void raise_error(const Status& status) {
  const py::object error =
      py::module_::import("tetstream._errors")
          .attr("error_of")(static_cast<int>(status.code()), status.message(), status.reason());
  PyErr_SetObject(py::type::of(error).ptr(), error.ptr());
  throw py::error_already_set();
}

Watch::Watch(py::object progress, std::optional<double> deadline)
    : progress_(std::move(progress)), reached_(std::make_shared<std::atomic<double>>(0)) {
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
  std::optional<py::error_already_set> interruption;
  std::exception_ptr failure;
  {
    const py::gil_scoped_release released;
    Worker worker(work);
    while (!worker.is_done_within(kLookUp)) {
      if (interruption) continue;  // it ends soon
      const py::gil_scoped_acquire held;
      interruption = look_up();
      if (interruption) stop();
    }
    failure = worker.failure();
  }
  if (interruption) throw py::error_already_set(*std::move(interruption));
  if (failure) std::rethrow_exception(failure);
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
