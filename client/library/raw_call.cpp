#include "client/library/raw_call.h"

#include <chrono>
#include <utility>

#include <absl/strings/str_cat.h>

namespace tet {

RawCall::RawCall(const std::shared_ptr<grpc::Channel>& channel,
                 grpc::ClientContext& context,
                 const std::string& service,
                 const std::string& method) {
  context.set_initial_metadata_corked(true);  // goes with the first message
  const std::string path = absl::StrCat("/", service, "/", method);
  call_ = grpc::GenericStub(channel).PrepareCall(&context, path, &queue_);
  call_->StartCall(nullptr);
}

RawCall::~RawCall() {
  queue_.Shutdown();
  while (done()) {
  }
}

bool RawCall::write(const grpc::ByteBuffer& message) {
  call_->Write(message, nullptr);
  return done();
}

bool RawCall::write_last(const grpc::ByteBuffer& message) {
  call_->WriteLast(message, grpc::WriteOptions(), nullptr);
  return done();
}

bool RawCall::writes_done() {
  call_->WritesDone(nullptr);
  return done();
}

bool RawCall::read(grpc::ByteBuffer& message) {
  begin_read();
  if (!std::exchange(has_read_, false)) read_ok_ = done();
  reading_ = false;
  message.Swap(&incoming_);
  incoming_.Clear();
  return read_ok_;
}

void RawCall::begin_read() {
  if (!std::exchange(reading_, true)) call_->Read(&incoming_, nullptr);
}

bool RawCall::can_read() {
  begin_read();
  if (has_read_) return true;
  void* tag = nullptr;
  has_read_ = queue_.AsyncNext(&tag, &read_ok_, std::chrono::system_clock::now()) !=
              grpc::CompletionQueue::TIMEOUT;
  return has_read_;
}

grpc::Status RawCall::finish() {
  grpc::Status status;
  call_->Finish(&status, nullptr);
  if (reading_ && !has_read_) done();  // both have ended, in whichever order
  done();
  return status;
}

bool RawCall::done() {
  void* tag = nullptr;
  bool ok = false;
  return queue_.Next(&tag, &ok) && ok;
}

}  // namespace tet
