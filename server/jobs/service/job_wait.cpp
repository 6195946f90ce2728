#include "server/jobs/service/job_wait.h"

#include <chrono>
#include <utility>

#include "proto/convert/status.h"
#include "server/jobs/service/job_messages.h"
#include "server/ops/guard.h"
#include "server/rpc/deadline.h"

namespace tet {

grpc::ServerUnaryReactor* JobWait::start(JobContext& shared,
                                         grpc::CallbackServerContext& context,
                                         const v1::WaitJobRequest& request,
                                         v1::Job& response) {
  const std::shared_ptr<JobWait> wait(new JobWait(shared, context, response));
  wait->self_ = wait;
  wait->answer_failure(guarded("WaitJob", [&] { wait->begin(request); }));
  return wait.get();
}

void JobWait::begin(const v1::WaitJobRequest& request) {
  const auto timeout = parse_wait(request);
  const absl::Status admitted = call_.admission();
  if (!admitted.ok() || !timeout.ok()) {
    return answer(admitted.ok() ? timeout.status() : admitted, {});
  }
  name_ = request.name();
  call_.on_cut([weak = weak_from_this()] {
    if (const auto self = weak.lock()) self->answer(shutting_down(), {});
  });
  shared_.threads.post(call_.client(), [self = shared_from_this(), timeout = *timeout] {
    self->answer_failure(guarded("WaitJob", [&] { self->wait(timeout); }));
  });
}

void JobWait::wait(absl::Duration timeout) {
  const auto job = shared_.find(call_.space(), name_);
  if (!job.ok()) return answer(job.status(), {});
  auto news = shared_.notifier.subscribe(job->space, job->id, [weak = weak_from_this()] {
    if (const auto self = weak.lock()) self->look_soon();
  });
  {
    const std::lock_guard lock(mutex_);
    if (answered_) return;
    subscription_ = std::move(news);
    timer_ = std::make_unique<grpc::Alarm>();
    timer_->Set(std::chrono::system_clock::now() + absl::ToChronoMicroseconds(timeout),
                [self = shared_from_this()](bool fired) {
                  if (fired) contain("WaitJob", [&] { self->time_is_up(); });
                });
  }
  look_soon();
}

void JobWait::time_is_up() {
  {
    const std::lock_guard lock(mutex_);
    time_is_up_ = true;
  }
  look_soon();
}

/// One look at a time, and another after it if there was news meanwhile.
void JobWait::look_soon() {
  {
    const std::lock_guard lock(mutex_);
    look_again_ = looking_;
    if (answered_ || std::exchange(looking_, true)) return;
  }
  shared_.threads.post(call_.client(), [self = shared_from_this()] {
    self->answer_failure(guarded("WaitJob", [&] { self->look(); }));
  });
}

void JobWait::look() {
  const auto job = shared_.find(call_.space(), name_);
  bool again = false;
  bool enough = false;
  {
    const std::lock_guard lock(mutex_);
    looking_ = false;
    again = std::exchange(look_again_, false);
    enough = time_is_up_ && !again;
  }
  if (!job.ok()) return answer(job.status(), {});
  if (enough || is_finished(job->state)) return answer(absl::OkStatus(), *job);
  if (again) look_soon();
}

void JobWait::answer(const absl::Status& status, const Job& job) {
  std::unique_ptr<grpc::Alarm> timer;  // goes without the lock
  {
    const std::lock_guard lock(mutex_);
    if (std::exchange(answered_, true)) return;
    timer = std::move(timer_);
    subscription_.reset();
  }
  const auto told = guarded("WaitJob", [&] {
    if (status.ok()) to_proto(job, true, response_);
    return status;
  });
  Finish(call_.finish(told));
}

void JobWait::answer_failure(const absl::Status& status) {
  if (!status.ok()) answer(status, {});
}

void JobWait::OnCancel() { answer(client_gone(Cancellation(deadline_of(context_))), {}); }

void JobWait::OnDone() { const std::shared_ptr<JobWait> last = std::move(self_); }

}  // namespace tet
