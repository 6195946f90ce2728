// A client that stops reading.
#pragma once

#include <memory>

#include "tetstream/v1/meshes.grpc.pb.h"

namespace tet::test {

/// A stream that is read as far as its first chunk, and then no further.
class HeldStream {
 public:
  HeldStream(::tetstream::v1::MeshService::Stub& meshes,
             const ::tetstream::v1::StreamMeshRequest& request)
      : reader_(meshes.StreamMesh(&context_, request)) {
    ::tetstream::v1::MeshEvent event;
    while (!has_chunk_ && reader_->Read(&event)) has_chunk_ = event.has_chunk();
  }

  /// Whether it has begun: else it was refused.
  bool has_chunk() const noexcept { return has_chunk_; }

  /// Whether it goes on to the end.
  bool read_on() {
    ::tetstream::v1::MeshEvent event;
    while (reader_->Read(&event)) {
    }
    return reader_->Finish().ok();
  }

  void let_go() {
    context_.TryCancel();
    reader_->Finish();
  }

 private:
  grpc::ClientContext context_;
  bool has_chunk_ = false;
  std::unique_ptr<grpc::ClientReader<::tetstream::v1::MeshEvent>> reader_;
};

}  // namespace tet::test
