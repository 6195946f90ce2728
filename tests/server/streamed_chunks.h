// A stream's chunks as they are on the wire.
#pragma once

#include <string>
#include <vector>

#include <grpcpp/client_context.h>
#include <gtest/gtest.h>

#include "tetstream/v1/meshes.grpc.pb.h"

namespace tet::test {

/// Each as the bytes of its event, in order. A failed test where the stream does not end well.
inline std::vector<std::string> streamed_chunks(
    ::tetstream::v1::MeshService::StubInterface& meshes,
    const ::tetstream::v1::StreamMeshRequest& request) {
  grpc::ClientContext context;
  const auto reader = meshes.StreamMesh(&context, request);
  std::vector<std::string> chunks;
  for (::tetstream::v1::MeshEvent event; reader->Read(&event);) {
    if (event.has_chunk()) chunks.push_back(event.SerializeAsString());
  }
  EXPECT_TRUE(reader->Finish().ok());
  return chunks;
}

}  // namespace tet::test
