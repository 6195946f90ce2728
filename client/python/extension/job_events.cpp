#include "client/python/extension/job_events.h"

#include <utility>

namespace tetstream::python {

JobEvents::JobEvents(const Jobs& jobs,
                     std::string name,
                     std::int64_t after_revision,
                     const CallOptions& options)
    : watch_(options.watch()), work_(options.connected(watch_)) {
  thread_ = std::jthread([this, jobs, name = std::move(name), after_revision] {
    watch(jobs, name, after_revision);
  });
}

JobEvents::~JobEvents() {
  watch_.stop();
  const py::gil_scoped_release released;
  thread_.join();
}

void JobEvents::watch(const Jobs& jobs, const std::string& name, std::int64_t after_revision) {
  const auto see = [this](const JobEvent& event) {
    const std::lock_guard lock(mutex_);
    events_.push_back(event);
    changed_.notify_all();
    return !closed_;
  };
  Status status = jobs.watch(name, after_revision, see, work_);
  const std::lock_guard lock(mutex_);
  end_ = std::move(status);
  changed_.notify_all();
}

std::optional<JobEvent> JobEvents::take() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !events_.empty() || end_; });
  if (events_.empty()) return std::nullopt;
  JobEvent event = std::move(events_.front());
  events_.pop_front();
  return event;
}

py::object JobEvents::next() {
  const std::optional<JobEvent> event = watch_.call([this] { return take(); });
  if (event) return to_python(*event);
  const std::lock_guard lock(mutex_);
  if (!closed_ && !end_->ok()) raise_error(*end_);
  return py::none();
}

void JobEvents::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  watch_.stop();
}

}  // namespace tetstream::python
