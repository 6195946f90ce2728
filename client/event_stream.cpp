#include "client/event_stream.h"

#include <absl/strings/str_cat.h>
#include <grpcpp/impl/codegen/proto_utils.h>

#include "tetstream/v1/meshes.grpc.pb.h"

namespace tet {

std::string stream_mesh_method() {
  return absl::StrCat("/", v1::MeshService::service_full_name(), "/StreamMesh");
}

grpc::ByteBuffer stream_mesh_bytes(const v1::StreamMeshRequest& request) {
  grpc::ByteBuffer message;
  bool own = false;
  grpc::SerializationTraits<v1::StreamMeshRequest>::Serialize(request, &message, &own);
  return message;
}

EventStream::EventStream(const std::shared_ptr<grpc::Channel>& channel,
                         grpc::ClientContext& context,
                         const v1::StreamMeshRequest& request) {
  context.set_initial_metadata_corked(true);  // sent with the request
  call_ = grpc::GenericStub(channel).PrepareCall(&context, stream_mesh_method(), &queue_);
  call_->StartCall(nullptr);
  call_->WriteLast(stream_mesh_bytes(request), grpc::WriteOptions(), nullptr);
  done();  // what kept it from being sent, `finish` tells
}

EventStream::~EventStream() {
  queue_.Shutdown();
  while (done()) {
  }
}

bool EventStream::read(grpc::ByteBuffer& event) {
  call_->Read(&event, nullptr);
  return done();
}

grpc::Status EventStream::finish() {
  grpc::Status status;
  call_->Finish(&status, nullptr);
  done();
  return status;
}

bool EventStream::done() {
  void* tag = nullptr;
  bool ok = false;
  return queue_.Next(&tag, &ok) && ok;
}

}  // namespace tet
