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
    while (reader_->Read(&event) && !event.has_chunk()) {
    }
  }

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
  std::unique_ptr<grpc::ClientReader<::tetstream::v1::MeshEvent>> reader_;
};

}  // namespace tet::test
