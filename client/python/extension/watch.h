// How Python waits for work of the library: without the GIL, and awake for Ctrl-C.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <type_traits>
#include <utility>

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "tetstream/request.h"
#include "tetstream/status.h"

namespace tetstream::python {

namespace py = pybind11;

/// Raises the Python exception that belongs to a failure.
[[noreturn]] void raise_error(const Status& status);

/// Looks up which thread handles signals. Python runs for it, and may let other threads run
/// meanwhile, so that the module does it before anybody can wait for a piece of work.
void find_main_thread();
/// In a process that was forked the one thread that is there handles signals.
void become_main_thread();

/// Whoever waits for a piece of work: lets other threads of Python run meanwhile, handles
/// signals, tells progress, and stops the work when one of these raises an exception. Made and
/// used with the GIL.
class Watch {
 public:
  /// `progress` is None or called with fractions, which only grow, by the thread that waits.
  /// `deadline` is in seconds since 1970, as Python's time.time has them. Another thread may
  /// stop the work by `stop_source`.
  Watch(py::object progress,
        std::optional<double> deadline,
        const std::stop_source& stop_source);

  /// Makes the work that gets these options stop and tell as the caller asked.
  void connect(WorkOptions& options) const;

  /// Waits for the result of `work`, which is called on another thread where this one handles
  /// signals or tells progress.
  template <class Function>
  std::invoke_result_t<Function> call(const Function& work) {
    std::optional<std::invoke_result_t<Function>> result;
    run([&] { result.emplace(work()); });
    return *std::move(result);
  }

  /// Tells how far a piece of work came, of those that are too short to be waited for. What the
  /// caller's function raises stops the work.
  void tell_reached();
  /// Tells that all is done, where progress is told at all.
  void finish();
  void stop() const { stop_source_.request_stop(); }

 private:
  void run(const std::function<void()>& work);
  void tell(double fraction);
  std::optional<py::error_already_set> look_up();

  const py::object progress_;
  std::optional<std::chrono::system_clock::time_point> deadline_;
  mutable std::stop_source stop_source_;
  const std::stop_callback<std::function<void()>> outer_;  ///< stops it as well
  const std::shared_ptr<std::atomic<double>> reached_;     ///< the largest fraction until now
  double told_ = -1;
};

/// The value of a result; raises where there is none.
template <class T>
T value_of(Result<T> result) {
  if (!result.ok()) raise_error(result.status());
  return *std::move(result);
}

}  // namespace tetstream::python
