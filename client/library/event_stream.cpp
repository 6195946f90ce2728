#include "client/library/event_stream.h"

#include <utility>

#include "client/library/raw_call.h"

namespace tet {

/// One stream, from the first chunk that is missing on.
struct EventStream::Attempt {
  Attempt(const ServerChannel& asked, const StreamCall& what, const Cancellation& cancellation)
      : server(asked),
        call(asked, cancellation),
        stream(asked.channel(), call.context(), what.service, what.method) {}

  const ServerChannel& server;
  ClientCall call;
  RawCall stream;
};

EventStream::EventStream(Connection& connection,
                         StreamCall call,
                         const Cancellation& cancellation)
    : connection_(connection),
      call_(std::move(call)),
      cancellation_(cancellation),
      retries_(connection.begin(cancellation)) {}

EventStream::~EventStream() {
  if (!attempt_) return;
  attempt_->call.context().TryCancel();
  attempt_->stream.finish();
}

void EventStream::begin() {
  attempt_ = std::make_unique<Attempt>(connection_.server(), call_, cancellation_);
  attempt_->stream.write_last(call_.request());
}

absl::StatusOr<bool> EventStream::step() {
  for (;;) {
    if (!attempt_) begin();
    grpc::ByteBuffer event;
    absl::Status status;
    if (next(event)) {
      status = call_.take(event);
      if (status.ok()) {
        connection_.answered();
        return true;
      }
      attempt_->call.context().TryCancel();
    }
    const bool given_up = cancellation_.requested();
    if (given_up) attempt_->call.context().TryCancel();
    const ServerChannel& server = attempt_->server;
    const absl::Status ended = end_attempt();
    if (call_.complete()) return false;
    if (status.ok() && given_up) return check_cancelled(cancellation_);
    if (status.ok()) status = ended;
    if (status.ok()) {
      status = absl::UnavailableError("the stream ended before all of it had come");
    }
    const absl::Status last = connection_.again(retries_, server, status, call_.next_chunk());
    if (!last.ok()) return last;
  }
}

/// The next event, wherever it comes; false where there is none, or nobody waits for it any
/// more.
bool EventStream::next(grpc::ByteBuffer& event) {
  RawCall& stream = attempt_->stream;
  const bool beside =
      call_.shared != nullptr &&
      call_.shared->take_event(event, cancellation_, [&] { return stream.can_read(); });
  // What is left beside the stream comes before what is in it.
  if (!beside && cancellation_.requested()) return false;
  return beside || stream.read(event);
}

absl::Status EventStream::end_attempt() {
  const absl::Status ended = attempt_->call.result(attempt_->stream.finish());
  attempt_.reset();
  return ended;
}

}  // namespace tet
