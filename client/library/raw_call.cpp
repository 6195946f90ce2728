#include "client/library/raw_call.h"

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
  call_->Read(&message, nullptr);
  return done();
}

grpc::Status RawCall::finish() {
  grpc::Status status;
  call_->Finish(&status, nullptr);
  done();
  return status;
}

bool RawCall::done() {
  void* tag = nullptr;
  bool ok = false;
  return queue_.Next(&tag, &ok) && ok;
}

}  // namespace tet
