#include "server/jobs/service/job_watch.h"

#include <utility>

#include <grpc/grpc.h>

#include "proto/convert/status.h"
#include "server/jobs/service/job_messages.h"
#include "server/ops/guard.h"
#include "server/rpc/deadline.h"

namespace tet {

namespace {

constexpr std::int64_t kEventsPerPage = 100;

}  // namespace

grpc::ServerWriteReactor<v1::JobEvent>* JobWatch::start(JobContext& shared,
                                                        grpc::CallbackServerContext& context,
                                                        const v1::WatchJobsRequest& request) {
  const std::shared_ptr<JobWatch> watch(new JobWatch(shared, context));
  watch->self_ = watch;
  shared.engine.stalls.add(watch);
  const absl::Status begun = guarded("WatchJobs", [&] { watch->begin(request); });
  if (!begun.ok()) watch->end_from_outside(begun);
  return watch.get();
}

JobWatch::JobWatch(JobContext& shared, grpc::CallbackServerContext& context)
    : shared_(shared), context_(context), call_(shared.engine.calls, context, "WatchJobs") {}

void JobWatch::begin(const v1::WatchJobsRequest& request) {
  if (const absl::Status admitted = call_.admission(); !admitted.ok()) {
    end(admitted);
    return advance();
  }
  query_.space = call_.space();
  query_.after_revision = request.after_revision();
  query_.limit = kEventsPerPage;
  call_.on_cut([weak = weak_from_this()] {
    if (const auto self = weak.lock()) self->end_from_outside(shutting_down());
  });
  shared_.threads.post([self = shared_from_this(), name = request.name()] {
    const absl::Status begun = guarded("WatchJobs", [&] {
      const absl::Status found = self->find_job(name);
      if (found.ok()) self->subscribe();
      return found;
    });
    if (!begun.ok()) return self->end_from_outside(begun);
    self->advance();
  });
}

void JobWatch::subscribe() {
  auto subscription =
      shared_.notifier.subscribe(query_.space, query_.job, [weak = weak_from_this()] {
        if (const auto self = weak.lock()) self->news();
      });
  const std::lock_guard lock(mutex_);
  if (!ended_) subscription_ = std::move(subscription);
}

/// A job that was deleted has its last events still, and nobody else's.
absl::Status JobWatch::find_job(const std::string& name) {
  if (name.empty()) return absl::OkStatus();
  const auto job = shared_.find(query_.space, name);
  if (!job.ok() && !absl::IsNotFound(job.status())) return job.status();
  query_.job = *parse_job_name(name);
  if (job.ok()) return absl::OkStatus();
  const auto left = shared_.jobs.watch(query_);
  return left.ok() && !left->events.empty() ? absl::OkStatus() : job.status();
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
      end(page.status());
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

/// Takes one step if there is one to take. gRPC is called without the lock; `writing_` and
/// `finished_` keep others out meanwhile.
void JobWatch::advance() {
  switch (next_step()) {
    case Step::kWait:
      return;
    case Step::kRead:
      return shared_.threads.post([self = shared_from_this()] { self->read(); });
    case Step::kWrite:
      return StartWrite(&outgoing_);
    case Step::kFinish:
      return Finish(call_.finish(status_));
  }
}

JobWatch::Step JobWatch::next_step() {
  const std::lock_guard lock(mutex_);
  if (writing_ || finished_ || cancelling_) return Step::kWait;
  if (events_.empty() && deleted_) end(absl::OkStatus());
  const bool any = !ended_ && !events_.empty();
  if (any) {
    const absl::Status told = guarded("WatchJobs", [&] {
      outgoing_.Clear();
      to_proto(events_.front(), outgoing_);
      events_.pop_front();
    });
    if (!told.ok()) end(told);
  }
  if (ended_) {
    finished_ = true;
    call_.note("events", written_);
    return Step::kFinish;
  }
  if (any) {
    writing_ = true;
    write_start_ = Stallable::Clock::now();
    return Step::kWrite;
  }
  if (reading_ || !std::exchange(news_, false)) return Step::kWait;
  reading_ = true;
  return Step::kRead;
}

/// Ends the watch. Called with the lock held; only the first status counts.
void JobWatch::end(const absl::Status& status) {
  if (std::exchange(ended_, true)) return;
  status_ = status;
}

void JobWatch::end_from_outside(const absl::Status& status) {
  {
    const std::lock_guard lock(mutex_);
    end(status);
  }
  advance();
}

void JobWatch::OnWriteDone(bool ok) {
  {
    const std::lock_guard lock(mutex_);
    writing_ = false;
    ++written_;
    if (!ok) end(client_gone(Cancellation()));
  }
  advance();
}

std::optional<Stallable::Clock::time_point> JobWatch::waiting_since() {
  const std::lock_guard lock(mutex_);
  if (!writing_ || ended_) return std::nullopt;
  return write_start_;
}

/// Ends the call of a client that took nothing for too long, as ChunkStream::give_up does.
void JobWatch::give_up(std::chrono::seconds waited) {
  const absl::Status status = client_stalled("took nothing", waited);
  {
    const std::lock_guard lock(mutex_);
    if (!writing_ || ended_) return;
    end(status);
    cancelling_ = true;
  }
  grpc_call_cancel_with_status(context_.c_call(), GRPC_STATUS_ABORTED,
                               std::string(status.message()).c_str(), nullptr);
  {
    const std::lock_guard lock(mutex_);
    cancelling_ = false;
  }
  advance();
}

void JobWatch::OnCancel() {
  end_from_outside(client_gone(Cancellation(deadline_of(context_))));
}

void JobWatch::OnDone() {
  const std::shared_ptr<JobWatch> last = std::move(self_);
  const std::lock_guard lock(mutex_);
  subscription_.reset();
}

}  // namespace tet
