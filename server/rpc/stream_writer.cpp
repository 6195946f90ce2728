#include "server/rpc/stream_writer.h"

#include <utility>

#include <grpc/grpc.h>

#include "proto/convert/status.h"
#include "server/ops/guard.h"
#include "server/rpc/deadline.h"

namespace tet {

StreamWriter::StreamWriter(CallRegistry& calls,
                           grpc::CallbackServerContext& context,
                           std::string method)
    : context_(context), call_(calls, context, std::move(method)) {}

void StreamWriter::close(const absl::Status& status) {
  {
    const std::lock_guard lock(mutex_);
    end(status);
  }
  advance();
}

/// What sees that it is abandoned may end the call, too, with another status; so that comes
/// after this one.
void StreamWriter::break_off(const absl::Status& status) {
  {
    const std::lock_guard lock(mutex_);
    end(status);
  }
  abandon();
  advance();
}

void StreamWriter::end(const absl::Status& status) {
  if (std::exchange(ended_, true)) return;
  status_ = status;
  note_end();
}

void StreamWriter::note_from_task(const std::string& key, const std::string& value) {
  const std::lock_guard lock(mutex_);
  if (!ended_) call_.note(key, value);
}

void StreamWriter::guard(const std::function<void()>& step) {
  const absl::Status status = guarded(call_.method().c_str(), step);
  if (!status.ok()) close(status);
}

/// gRPC is called without the lock; `writing_` and `finished_` keep others out meanwhile.
void StreamWriter::advance() {
  switch (next_step()) {
    case Step::kWait:
      return;
    case Step::kWrite:
      return write();
    case Step::kFinish:
      before_finish();
      return finish(call_.finish(status_));
  }
}

StreamWriter::Step StreamWriter::next_step() {
  const std::lock_guard lock(mutex_);
  if (writing_ || finished_ || held_ > 0) return Step::kWait;
  bool prepared = false;
  if (!ended_) {
    const absl::Status status = guarded(call_.method().c_str(), [&] { prepared = prepare(); });
    if (!status.ok()) end(status);
  }
  if (ended_) {
    finished_ = true;
    note_finish();
    return Step::kFinish;
  }
  if (!prepared) return Step::kWait;
  writing_ = true;
  write_start_ = Stallable::Clock::now();
  return Step::kWrite;
}

void StreamWriter::written(bool ok) {
  bool all = false;
  {
    const std::lock_guard lock(mutex_);
    writing_ = false;
    if (!ok) end(gone());
    const absl::Status status =
        guarded(call_.method().c_str(), [&] { all = after_write() && !ended_; });
    if (!status.ok()) end(status);
  }
  if (!ok) abandon();
  if (all) guard([this] { sent_all(); });
  advance();
}

std::optional<Stallable::Clock::time_point> StreamWriter::waiting_since() {
  const std::lock_guard lock(mutex_);
  if (!writing_ || ended_) return std::nullopt;
  return write_start_;
}

/// The message being written bars the way to any status, so the call is cancelled with it.
void StreamWriter::give_up(std::chrono::seconds waited) {
  const absl::Status status = client_stalled("took nothing", waited);
  {
    const std::lock_guard lock(mutex_);
    if (!writing_ || ended_) return;
    end(status);
    ++held_;
  }
  abandon();
  hold_while([&] {
    grpc_call_cancel_with_status(context_.c_call(), GRPC_STATUS_ABORTED,
                                 std::string(status.message()).c_str(), nullptr);
  });
}

void StreamWriter::start_operation(const std::function<void()>& start) {
  {
    const std::lock_guard lock(mutex_);
    if (ended_) return;
    ++held_;
  }
  hold_while(start);
}

/// `action` may bring events here and now, so it is not called under the lock; and gRPC must
/// not be done meanwhile. To be called with one more in `held_`, which it takes back.
void StreamWriter::hold_while(const std::function<void()>& action) {
  action();
  {
    const std::lock_guard lock(mutex_);
    --held_;
  }
  advance();
}

/// The client goes on elsewhere, with what it has.
void StreamWriter::end_with_server() {
  call_.on_cut([weak = weak_from_this()] {
    if (const auto self = weak.lock()) self->break_off(shutting_down());
  });
}

void StreamWriter::cancelled() { break_off(gone()); }

absl::Status StreamWriter::gone() const {
  return client_gone(Cancellation(deadline_of(context_)));
}

}  // namespace tet
