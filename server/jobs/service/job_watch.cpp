#include "server/jobs/service/job_watch.h"

#include <utility>

#include "proto/convert/status.h"
#include "proto/wire/transport.h"
#include "server/jobs/service/job_messages.h"
#include "server/ops/guard.h"

namespace tet {

namespace {

constexpr std::int64_t kEventsPerPage = 100;

}  // namespace

grpc::ServerWriteReactor<v1::JobEvent>* JobWatch::start(JobContext& shared,
                                                        grpc::CallbackServerContext& context,
                                                        const v1::WatchJobsRequest& request) {
  const std::shared_ptr<JobWatch> watch(new JobWatch(shared, context));
  watch->kept_ = watch;
  shared.engine.stalls.add(watch);
  watch->guard([&] { watch->begin(request); });
  return watch.get();
}

JobWatch::JobWatch(JobContext& shared, grpc::CallbackServerContext& context)
    : StreamWriter(shared.engine.calls, context, "WatchJobs"), shared_(shared) {}

void JobWatch::begin(const v1::WatchJobsRequest& request) {
  if (const absl::Status admitted = call_.admission(); !admitted.ok()) return close(admitted);
  const std::uint64_t most = shared_.engine.config.max_client_watches;
  counted_ = shared_.watches.enter(call_.client(), most);
  if (!counted_) return close(over_quota(call_.client(), "watches of jobs", most + 1, most));
  query_.space = call_.space();
  query_.after_revision = request.after_revision();
  query_.limit = kEventsPerPage;
  end_with_server();
  shared_.threads.post(call_.client(), [self = self(), name = request.name()] {
    self->guard([&] {
      const absl::Status found = self->find_job(name);
      if (!found.ok()) return self->close(found);
      self->start_operation([&] { self->tell_beginning(); });
    });
  });
}

/// Nothing is written meanwhile, whatever happens from now on.
void JobWatch::tell_beginning() {
  context_.AddInitialMetadata(kWatchBegun, "1");
  StartSendInitialMetadata();
  subscribe();
}

void JobWatch::subscribe() {
  auto subscription =
      shared_.notifier.subscribe(query_.space, query_.job, [weak = std::weak_ptr(self())] {
        if (const auto self = weak.lock()) self->news();
      });
  const std::lock_guard lock(mutex_);
  if (!ended()) subscription_ = std::move(subscription);
}

/// A job that was deleted has its last events still, and nobody else's. One that was purged has
/// them for a moment, and none of them says that it was deleted.
absl::Status JobWatch::find_job(const std::string& name) {
  if (name.empty()) return absl::OkStatus();
  const auto job = shared_.find(query_.space, name);
  if (!job.ok() && !absl::IsNotFound(job.status())) return job.status();
  query_.job = *parse_job_name(name);
  if (job.ok()) return absl::OkStatus();
  const auto left = shared_.jobs.watch(query_);
  if (!left.ok() || left->events.empty()) return job.status();
  const std::lock_guard lock(mutex_);
  gone_ = true;
  return absl::OkStatus();
}

void JobWatch::news() {
  {
    const std::lock_guard lock(mutex_);
    news_ = true;
  }
  advance();
}

/// Only this task touches the query.
void JobWatch::read() {
  auto page = guarded("WatchJobs", [&] { return shared_.jobs.watch(query_); });
  {
    const std::lock_guard lock(mutex_);
    reading_ = false;
    if (!page.ok()) {
      end(gone_ && absl::IsNotFound(page.status()) ? absl::OkStatus() : page.status());
    } else {
      query_.after_revision = page->revision;
      news_ = news_ || std::ssize(page->events) == kEventsPerPage;
      for (JobEvent& event : page->events) {
        deleted_ = !query_.job.empty() && event.change == JobChange::kDeleted;
        events_.push_back(std::move(event));
      }
    }
  }
  advance();
}

/// The next event; or what brings more of them is begun.
bool JobWatch::prepare() {
  if (!events_.empty()) {
    outgoing_.Clear();
    to_proto(events_.front(), outgoing_);
    events_.pop_front();
    return true;
  }
  const bool reads = !deleted_ && !reading_ && std::exchange(news_, false);
  if (reads) {
    reading_ = true;
    shared_.threads.post(call_.client(), [self = self()] { self->read(); });
  } else if (deleted_ || (gone_ && !reading_)) {
    end(absl::OkStatus());
  }
  return false;
}

bool JobWatch::after_write() {
  ++written_;
  return false;
}

void JobWatch::OnDone() {
  const std::shared_ptr<JobWatch> last = std::move(kept_);
  if (counted_) shared_.watches.leave(call_.client());
  const std::lock_guard lock(mutex_);
  subscription_.reset();
}

}  // namespace tet
