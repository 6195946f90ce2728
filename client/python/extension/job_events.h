// What happens to jobs, one event after the other, as Python iterates over it.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "client/python/extension/bindings.h"
#include "tetstream/jobs.h"

namespace tetstream::python {

/// Watches on a thread of its own, and keeps what comes until somebody asks for it.
class JobEvents {
 public:
  JobEvents(const Jobs& jobs,
            std::string name,
            std::int64_t after_revision,
            const CallOptions& options);
  ~JobEvents();
  JobEvents(const JobEvents&) = delete;
  JobEvents& operator=(const JobEvents&) = delete;

  /// The next event; None where there are no more.
  py::object next();
  void close();

 private:
  void watch(const Jobs& jobs, const std::string& name, std::int64_t after_revision);
  /// Waits for an event or the end.
  std::optional<JobEvent> take();

  Watch watch_;
  WorkOptions work_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<JobEvent> events_;
  std::optional<Status> end_;
  bool closed_ = false;
  std::jthread thread_;  // last: it uses the others
};

}  // namespace tetstream::python
