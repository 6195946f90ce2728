#include "tetstream/jobs.h"

#include <chrono>
#include <memory>
#include <string>

#include <pybind11/stl.h>

#include "client/python/extension/job_events.h"
#include "client/python/extension/stream.h"

namespace tetstream::python {
namespace {

py::object seconds_of(const Job::Time& time) {
  if (!time) return py::none();
  return py::float_(std::chrono::duration<double>(time->time_since_epoch()).count());
}

py::object seconds_of(const std::optional<std::chrono::milliseconds>& span) {
  if (!span) return py::none();
  return py::float_(std::chrono::duration<double>(*span).count());
}

/// Takes a positive number of seconds. What 64 bits do not hold is as good as no end.
std::optional<std::chrono::milliseconds> span_of(std::optional<double> seconds) {
  constexpr double kMost = 0x1p63;
  if (!seconds || !(1000 * *seconds < kMost)) return std::nullopt;
  return std::chrono::milliseconds(static_cast<std::int64_t>(1000 * *seconds));
}

py::tuple progress_of(const JobProgress& progress) {
  return py::make_tuple(progress.chunk_count, progress.done_chunks, progress.shard_count,
                        progress.done_shards, progress.running_shards, progress.dead_shards,
                        progress.chunks_per_second, progress.eta_seconds);
}

/// Code, message and reason; None where nothing has failed.
py::object error_of(const Status& status) {
  if (status.ok()) return py::none();
  return py::make_tuple(static_cast<int>(status.code()), status.message(), status.reason());
}

template <class Solid>
py::dict submit(const Jobs& jobs,
                const Solid& solid,
                const Request& request,
                const JobOrder& order,
                const CallOptions& options) {
  return to_python(call(options, [&](const WorkOptions& work) {
    return jobs.submit(solid, request, order, work);
  }));
}

using JobCall = Result<Job> (Jobs::*)(const std::string&, const WorkOptions&) const;

/// One call about one job.
template <JobCall kCall>
py::dict ask(const Jobs& jobs, const std::string& name, const CallOptions& options) {
  return to_python(
      call(options, [&](const WorkOptions& work) { return (jobs.*kCall)(name, work); }));
}

void remove(const Jobs& jobs, const std::string& name, const CallOptions& options) {
  Watch watch = options.watch();
  const WorkOptions work = options.connected(watch);
  const Status status = watch.call([&] { return jobs.remove(name, work); });
  if (!status.ok()) raise_error(status);
}

py::tuple list(const Jobs& jobs, const JobFilter& filter, const CallOptions& options) {
  const JobList listed =
      call(options, [&](const WorkOptions& work) { return jobs.list(filter, work); });
  py::list all;
  for (const Job& job : listed.jobs) all.append(to_python(job));
  return py::make_tuple(all, listed.revision);
}

Mesh fetch(const Jobs& jobs, const std::string& name, const CallOptions& options) {
  return call(options, [&](const WorkOptions& work) { return jobs.fetch(name, work); });
}

std::unique_ptr<Stream> stream(const Jobs& jobs,
                               const std::string& name,
                               const CallOptions& options,
                               std::uint64_t first,
                               std::optional<std::uint64_t> end) {
  return std::make_unique<Stream>(options, [&](const WorkOptions& work) {
    return jobs.stream(name, work, chunks_of(first, end));
  });
}

std::unique_ptr<JobEvents> watch(const Jobs& jobs,
                                 const std::string& name,
                                 std::int64_t after_revision,
                                 const CallOptions& options) {
  return std::make_unique<JobEvents>(jobs, name, after_revision, options);
}

void bind_orders(py::module_& module) {
  py::enum_<JobState>(module, "JobState")
      .value("queued", JobState::kQueued)
      .value("running", JobState::kRunning)
      .value("succeeded", JobState::kSucceeded)
      .value("failed", JobState::kFailed)
      .value("cancelled", JobState::kCancelled)
      .value("expired", JobState::kExpired);
  py::enum_<JobChange>(module, "JobChange")
      .value("created", JobChange::kCreated)
      .value("started", JobChange::kStarted)
      .value("planned", JobChange::kPlanned)
      .value("shard_done", JobChange::kShardDone)
      .value("shard_dead", JobChange::kShardDead)
      .value("finished", JobChange::kFinished)
      .value("retried", JobChange::kRetried)
      .value("determinism_alarm", JobChange::kDeterminismAlarm)
      .value("deleted", JobChange::kDeleted)
      .value("replanned", JobChange::kReplanned);
  py::class_<JobOrder>(module, "JobOrder")
      .def(py::init<>())
      .def_readwrite("display_name", &JobOrder::display_name)
      .def_readwrite("labels", &JobOrder::labels)
      .def_readwrite("priority", &JobOrder::priority)
      .def_readwrite("max_attempts", &JobOrder::max_attempts)
      .def_readwrite("skip_cache", &JobOrder::skip_cache)
      .def_readwrite("request_id", &JobOrder::request_id)
      .def("set_times",
           [](JobOrder& order, std::optional<double> ttl, std::optional<double> timeout) {
             order.ttl = span_of(ttl);
             order.timeout = span_of(timeout);
           });
  py::class_<JobFilter>(module, "JobFilter")
      .def(py::init<>())
      .def_readwrite("states", &JobFilter::states)
      .def_readwrite("labels", &JobFilter::labels)
      .def_readwrite("display_name_prefix", &JobFilter::display_name_prefix)
      .def_readwrite("most", &JobFilter::most);
}

}  // namespace

py::dict to_python(const Job& job) {
  py::object header = py::none();
  if (job.header) header = to_python(*job.header);
  return py::dict(
      py::arg("name") = job.name, py::arg("display_name") = job.order.display_name,
      py::arg("labels") = job.order.labels, py::arg("priority") = job.order.priority,
      py::arg("ttl") = seconds_of(job.order.ttl),
      py::arg("timeout") = seconds_of(job.order.timeout), py::arg("state") = job.state,
      py::arg("version") = job.version, py::arg("created") = seconds_of(job.created),
      py::arg("started") = seconds_of(job.started),
      py::arg("finished") = seconds_of(job.finished),
      py::arg("queue_position") = job.queue_position,
      py::arg("progress") = progress_of(job.progress), py::arg("error") = error_of(job.error),
      py::arg("cached") = job.cached, py::arg("header") = header);
}

py::object to_python(const JobEvent& event) {
  return py::dict(py::arg("revision") = event.revision, py::arg("name") = event.name,
                  py::arg("version") = event.version, py::arg("change") = event.change,
                  py::arg("state") = event.state,
                  py::arg("progress") = progress_of(event.progress),
                  py::arg("time") = seconds_of(event.time));
}

void bind_jobs(py::module_& module) {
  bind_orders(module);
  py::class_<JobEvents>(module, "JobEvents")
      .def("next", &JobEvents::next)
      .def("close", &JobEvents::close);
  py::class_<Jobs>(module, "Jobs")
      .def(py::init<const Client&>())
      .def("submit", &submit<StoredVolume>)
      .def("submit", &submit<Scene>)
      .def("get", &ask<&Jobs::get>)
      .def("cancel", &ask<&Jobs::cancel>)
      .def("retry", &ask<&Jobs::retry>)
      .def("wait", &ask<&Jobs::wait>)
      .def("remove", &remove)
      .def("list", &list)
      .def("fetch", &fetch)
      .def("stream", &stream, py::arg("name"), py::arg("options"), py::arg("first") = 0,
           py::arg("end") = py::none())
      .def("watch", &watch);
}

}  // namespace tetstream::python
