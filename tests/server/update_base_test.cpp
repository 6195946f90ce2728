// Updates whose base cannot be had when they are resumed.
#include <cstdint>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/vdb/openvdb/load.h"
#include "tests/server/held_stream.h"
#include "tests/server/service_fixture.h"

namespace tet::test {
namespace {

using UpdateBaseTest = ServiceTest;

TEST_F(UpdateBaseTest, AsksWhoeverResumesAnUpdateToWaitForRoomForItsBase) {
  const std::string before = solid_file("sphere", 0.04), after = solid_file("cavity", 0.04);
  config_.resident_bytes =
      load_volume(before, "")->size_bytes() + load_volume(after, "")->size_bytes() - 1;
  start();
  const v1::MeshRequest sphere = mesh_of(before);
  v1::StreamMeshRequest update = stream_of(mesh_of(after));
  HeldStream other(*meshes_, update);  // with the only grid that there is room for
  ASSERT_TRUE(other.has_chunk());
  v1::StreamMeshRequest begun = update;
  begun.set_base_mesh_id("the sphere's");
  begun.set_base_name(sphere.name());
  v1::StreamMeshRequest resumed = begun;
  resumed.set_start_chunk(1);
  const auto end_of = [&](const v1::StreamMeshRequest& request) {
    grpc::ClientContext context;
    const auto reader = meshes_->StreamMesh(&context, request);
    for (v1::MeshEvent event; reader->Read(&event);) {
    }
    return reader->Finish();
  };
  EXPECT_TRUE(end_of(begun).ok());
  const grpc::Status busy = end_of(resumed);
  EXPECT_EQ(busy.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED) << busy.error_message();
  EXPECT_THAT(busy.error_details(), testing::HasSubstr("google.rpc.RetryInfo"));
  other.let_go();
  EXPECT_TRUE(eventually([&] { return end_of(resumed).ok(); })) << "which is no base after all";
}

// There is room for either grid, whatever else goes on: an update is a whole mesh then.
TEST_F(UpdateBaseTest, SendsTheWholeMeshWhereItsBaseLeavesNoRoomForIt) {
  const std::string before = solid_file("sphere", 0.04), after = solid_file("cavity", 0.04);
  config_.resident_bytes =
      load_volume(before, "")->size_bytes() + load_volume(after, "")->size_bytes() - 1;
  start();
  v1::MeshHeader header;
  grpc::Status status;
  // Asked again where there is no room yet: the server lets a stream's grid go after its client
  // has all of it.
  const auto is_answered = [&](const v1::StreamMeshRequest& request) {
    grpc::ClientContext context;
    const auto reader = meshes_->StreamMesh(&context, request);
    for (v1::MeshEvent event; reader->Read(&event);) {
      if (event.has_header()) header = event.header();
    }
    status = reader->Finish();
    return status.error_code() != grpc::StatusCode::RESOURCE_EXHAUSTED;
  };
  const auto header_of = [&](const v1::StreamMeshRequest& request) {
    EXPECT_TRUE(eventually([&] { return is_answered(request); }));
    EXPECT_TRUE(status.ok()) << status.error_message();
    return header;
  };
  const v1::MeshRequest sphere = mesh_of(before);
  v1::StreamMeshRequest update = stream_of(mesh_of(after));
  update.set_base_mesh_id(header_of(stream_of(sphere)).mesh_id());
  update.set_base_name(sphere.name());
  const v1::MeshHeader updated = header_of(update);
  EXPECT_GT(updated.chunk_count(), 0);
  EXPECT_FALSE(updated.has_kept());
}

/// A base that is gone when an update of more patches than the mesh has chunks is resumed.
TEST_F(UpdateBaseTest, TellsWhoeverResumesBehindTheLastChunkThatItsBaseIsGone) {
  start();
  v1::StreamMeshRequest resumed = stream_of(mesh_of(solid_file("cavity", 0.1)));
  resumed.set_base_mesh_id("another's");
  resumed.set_base_name("grids/" + std::string(64, '0'));
  const auto header_of = [&](std::int64_t first) {
    resumed.set_start_chunk(first);
    grpc::ClientContext context;
    const auto reader = meshes_->StreamMesh(&context, resumed);
    v1::MeshHeader header;
    for (v1::MeshEvent event; reader->Read(&event);) {
      if (event.has_header()) header = event.header();
      EXPECT_FALSE(event.has_chunk() && first > 0);
    }
    const grpc::Status end = reader->Finish();
    EXPECT_TRUE(end.ok()) << end.error_message();
    return header;
  };
  const v1::MeshHeader whole = header_of(0);
  ASSERT_GT(whole.chunk_count(), 0);
  const v1::MeshHeader told = header_of(whole.chunk_count() + 1);
  EXPECT_EQ(told.mesh_id(), whole.mesh_id());
  EXPECT_FALSE(told.has_kept());
}

}  // namespace
}  // namespace tet::test
