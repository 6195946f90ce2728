// The encodings that a client may ask for: the same mesh of each.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "client/library/mesh_client.h"
#include "core/mesh/face_counts.h"
#include "core/mesh/find_faces.h"
#include "tests/client/cutting_proxy.h"
#include "tests/core/plan/meshing.h"
#include "tests/server/service_fixture.h"

namespace tet::test {
namespace {

class EncodingsTest : public ServiceTest {
 protected:
  EncodingsTest() { start(); }
};

void expect_same_stream(const StreamedMesh& a, const StreamedMesh& b) {
  EXPECT_TRUE(test::same_bytes(a.mesh, b.mesh));
  EXPECT_TRUE(a.mesh.header.origin == b.mesh.header.origin);
  EXPECT_EQ(a.mesh_id, b.mesh_id);
}

TEST_F(EncodingsTest, MakeTheSameMesh) {
  for (const v1::MeshRequest& request :
       {uniform_ball(16), both_sides_of_ball(16, 2), mesh_of(solid_file("gyroid", 0.08))}) {
    const auto plain = client_->stream_mesh(request, {}, never_);
    for (const v1::Encoding encoding : {v1::ENCODING_PACKED, v1::ENCODING_COMPACT}) {
      const auto encoded =
          client_->stream_mesh(request, {}, never_, {.encoding = encoding, .used = {}});
      ASSERT_TRUE(plain.ok() && encoded.ok()) << plain.status() << encoded.status();
      expect_same_stream(*encoded, *plain);
      EXPECT_EQ(encoded->quality.volume, plain->quality.volume);
      EXPECT_EQ(encoded->quality.histogram, plain->quality.histogram);
      EXPECT_TRUE(encoded->boundary == plain->boundary);
    }
  }
}

TEST_F(EncodingsTest, CarryTheSameFaces) {
  v1::MeshRequest fine = mesh_of(solid_file("gyroid", 0.08));
  for (v1::MeshRequest request : {uniform_ball(16), both_sides_of_ball(16, 2), fine}) {
    const auto without = client_->stream_mesh(request, {}, never_);
    request.set_faces(true);
    const auto plain = client_->stream_mesh(request, {}, never_);
    ASSERT_TRUE(without.ok() && plain.ok()) << without.status() << plain.status();
    EXPECT_FALSE(without->mesh.header.has_faces());
    EXPECT_NE(plain->mesh_id, without->mesh_id);
    EXPECT_GT(plain->mesh.header.face_count, 100U);
    TetMesh found(plain->mesh.header);
    set_faces(find_faces(plain->mesh), plain->mesh, found);
    EXPECT_TRUE(std::ranges::equal(plain->mesh.faces.bytes(), found.faces.bytes()));
    for (const v1::Encoding encoding : {v1::ENCODING_PACKED, v1::ENCODING_COMPACT}) {
      const auto encoded =
          client_->stream_mesh(request, {}, never_, {.encoding = encoding, .used = {}});
      ASSERT_TRUE(encoded.ok()) << encoded.status();
      expect_same_stream(*encoded, *plain);
      EXPECT_EQ(encoded->mesh.header.face_labels, plain->mesh.header.face_labels);
    }
  }
}

TEST_F(EncodingsTest, CarryTheSameRegionsOfFaces) {
  for (v1::MeshRequest request : {uniform_ball(16), both_sides_of_ball(16, 2)}) {
    v1::FaceRegion& half = *request.add_face_regions();
    half.set_name("half");
    half.mutable_half_space()->mutable_normal()->Add(1);
    half.mutable_half_space()->mutable_normal()->Resize(3, 0);
    half.mutable_half_space()->set_offset(0.01);
    const auto plain = client_->stream_mesh(request, {}, never_);
    ASSERT_TRUE(plain.ok()) << plain.status();
    const auto counts = count_faces(plain->mesh);
    EXPECT_EQ(plain->mesh.header.face_labels.back().name, "half");
    EXPECT_GT(counts.front(), 10U);
    EXPECT_GT(counts.back(), 10U);
    for (const v1::Encoding encoding : {v1::ENCODING_PACKED, v1::ENCODING_COMPACT}) {
      const auto encoded =
          client_->stream_mesh(request, {}, never_, {.encoding = encoding, .used = {}});
      ASSERT_TRUE(encoded.ok()) << encoded.status();
      expect_same_stream(*encoded, *plain);
    }
  }
}

TEST_F(EncodingsTest, LeaveStatisticsOutWhereTheRequestDoes) {
  v1::MeshRequest ball = uniform_ball(16);
  ball.set_skip_statistics(true);
  std::vector<StreamedMesh> meshes;
  for (const v1::Encoding encoding :
       {v1::ENCODING_PLAIN, v1::ENCODING_PACKED, v1::ENCODING_COMPACT}) {
    auto only = client_->stream_mesh(ball, {}, never_, {.encoding = encoding, .used = {}});
    ASSERT_TRUE(only.ok()) << only.status();
    EXPECT_TRUE(only->quality.empty());
    EXPECT_FALSE(only->boundary);
    meshes.push_back(*std::move(only));
  }
  ball.clear_skip_statistics();
  const auto measured = client_->stream_mesh(ball, {}, never_);
  ASSERT_TRUE(measured.ok()) << measured.status();
  EXPECT_FALSE(measured->quality.empty());
  EXPECT_TRUE(measured->boundary);
  for (const StreamedMesh& only : meshes) expect_same_stream(only, *measured);
}

TEST_F(EncodingsTest, ReceiveAMeshInTheMemoryOfAnother) {
  const v1::MeshRequest small = uniform_ball(16);
  const auto whole = client_->stream_mesh(small, {}, never_);
  for (const v1::Encoding encoding :
       {v1::ENCODING_PLAIN, v1::ENCODING_PACKED, v1::ENCODING_COMPACT}) {
    auto larger = client_->stream_mesh(uniform_ball(18), {}, never_);
    ASSERT_TRUE(whole.ok() && larger.ok()) << whole.status() << larger.status();
    const std::byte* const memory = larger->mesh.tets.bytes().data();
    const auto streamed = client_->stream_mesh(
        small, {}, never_, {.encoding = encoding, .used = std::move(larger->mesh)});
    ASSERT_TRUE(streamed.ok()) << streamed.status();
    EXPECT_EQ(streamed->mesh.tets.bytes().data(), memory);
    expect_same_stream(*streamed, *whole);
  }
}

TEST_F(EncodingsTest, MendAStreamThatBreaksAgainAndAgain) {
  constexpr std::uint64_t kUnlimited = ~std::uint64_t{0};
  const v1::MeshRequest ball = uniform_ball(28);
  const auto whole = client_->stream_mesh(ball, {}, never_);
  ASSERT_TRUE(whole.ok()) << whole.status();
  for (const v1::Encoding encoding : {v1::ENCODING_PACKED, v1::ENCODING_COMPACT}) {
    const std::uint64_t down = encoding == v1::ENCODING_PACKED ? 300'000 : 50'000;
    CuttingProxy proxy(server_->port(), kUnlimited, down);
    const auto client =
        MeshClient::connect(proxy.address(), {.attempts = 6, .first_backoff_ms = 10});
    const auto streamed =
        client->stream_mesh(ball, {}, never_, {.encoding = encoding, .used = {}});
    ASSERT_TRUE(streamed.ok()) << streamed.status();
    EXPECT_GT(proxy.cuts(), 0);
    expect_same_stream(*streamed, *whole);
  }
}

}  // namespace
}  // namespace tet::test
