// Sessions whose mesh is patched in place.
#include <vector>

#include <gtest/gtest.h>

#include "core/base/parallel.h"
#include "core/vdb/openvdb/load.h"
#include "tests/core/plan/meshing.h"
#include "tests/server/session_fixture.h"

namespace tet::test {
namespace {

using StableSessionTest = RemeshSessionTest;

TetMesh in_order(const RemeshSession& session) {
  absl::StatusOr<TetMesh> mesh = absl::InternalError("not made");
  TaskPool(2).run([&] { mesh = session.stable()->in_order(); });
  EXPECT_TRUE(mesh.ok()) << mesh.status();
  return mesh.ok() ? *std::move(mesh) : TetMesh();
}

TEST_F(StableSessionTest, IsTheMeshOfAnotherSessionInOrder) {
  start();
  const std::string path = solid_file("torus", 0.05);
  const Volume volume = load_volume(path, "").value();
  const Session plain = begin(mesh_of(path));
  auto stable = client_->begin_session(mesh_of(path), never_, SessionIds::kStable);
  ASSERT_TRUE(plain && stable.ok()) << stable.status();
  EXPECT_EQ(plain->stable(), nullptr);
  for (std::size_t frame = 0; frame < 4; ++frame) {
    SCOPED_TRACE(frame);
    EXPECT_EQ((*stable)->mesh().mesh_id, plain->mesh().mesh_id);
    EXPECT_EQ((*stable)->tets_sent(), plain->tets_sent());
    EXPECT_TRUE(same_bytes(in_order(**stable), plain->mesh().mesh));
    const std::vector<v1::LeafUpdate> leaves{inflated(volume, 3 * frame),
                                             inflated(volume, 3 * frame + 1)};
    ASSERT_EQ(plain->update(leaves), absl::OkStatus());
    ASSERT_EQ((*stable)->update(leaves), absl::OkStatus());
    EXPECT_LT((*stable)->tets_sent(), plain->mesh().mesh.header.tet_count);
  }
}

TEST_F(StableSessionTest, StaysAsItIsWhereAFrameIsRefused) {
  start();
  const std::string path = solid_file("torus", 0.05);
  const Volume volume = load_volume(path, "").value();
  auto session = client_->begin_session(mesh_of(path), never_, SessionIds::kStable);
  ASSERT_TRUE(session.ok()) << session.status();
  ASSERT_EQ((*session)->update({inflated(volume, 2)}), absl::OkStatus());
  const TetMesh before = in_order(**session);
  std::vector<v1::LeafUpdate> bad{inflated(volume, 4)};
  bad[0].set_y(bad[0].y() + 3);
  EXPECT_EQ((*session)->update(bad).code(), absl::StatusCode::kInvalidArgument);
  EXPECT_FALSE((*session)->is_over());
  EXPECT_TRUE(same_bytes(in_order(**session), before));
  EXPECT_EQ((*session)->update({inflated(volume, 4)}), absl::OkStatus());
}

}  // namespace
}  // namespace tet::test
