#include "server/http/forwarded_call.h"

#include <utility>

namespace tet {

void ForwardedCall::start(const CallOrder& order,
                          const std::shared_ptr<grpc::GenericStub>& stub) {
  stub_ = stub;
  self_ = shared_from_this();
  loop_.hold();
  for (const auto& [name, value] : order.metadata) context_.AddMetadata(name, value);
  forward_for(order.peer, context_);
  if (order.timeout) context_.set_deadline(std::chrono::system_clock::now() + *order.timeout);
  stub_->PrepareBidiStreamingCall(&context_, order.method, {}, this);
  AddHold();
  held_ = true;
  StartCall();
  read();
}

void ForwardedCall::write(grpc::ByteBuffer message, bool last) {
  if (!held_) return;  // the call has ended, and its sink is about to hear of it
  outgoing_.Swap(&message);
  if (last) {
    StartWriteLast(&outgoing_, {});
  } else {
    StartWrite(&outgoing_);
  }
}

void ForwardedCall::read() {
  if (!held_ || std::exchange(reading_, true)) return;
  incoming_.Clear();
  StartRead(&incoming_);
}

void ForwardedCall::abandon() {
  sink_ = nullptr;
  context_.TryCancel();
  if (!reading_) release();
}

void ForwardedCall::release() {
  if (std::exchange(held_, false)) RemoveHold();
}

void ForwardedCall::OnReadDone(bool ok) {
  loop_.post([self = shared_from_this(), ok] {
    self->reading_ = false;
    if (!ok || self->sink_ == nullptr) return self->release();
    grpc::ByteBuffer message;
    message.Swap(&self->incoming_);
    self->sink_->on_message(message);
  });
}

void ForwardedCall::OnWriteDone(bool ok) {
  if (!ok) return;  // the read tells of the end
  loop_.post([self = shared_from_this()] {
    if (self->sink_ != nullptr && self->held_) self->sink_->on_written();
  });
}

void ForwardedCall::OnDone(const grpc::Status& status) {
  loop_.post([self = shared_from_this(), status] {
    Trailers trailers;
    for (const auto& [name, value] : self->context_.GetServerTrailingMetadata()) {
      trailers.emplace_back(std::string(name.data(), name.size()),
                            std::string(value.data(), value.size()));
    }
    if (CallSink* const sink = std::exchange(self->sink_, nullptr)) {
      sink->on_end(status, trailers);
    }
    self->loop_.release();
    self->self_.reset();
  });
}

}  // namespace tet
