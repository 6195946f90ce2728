#include "client/library/mesh_client.h"

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <grpc/grpc.h>
#include <gtest/gtest.h>

#include "client/library/mesh_receiver.h"
#include "client/library/remesh_session.h"
#include "core/plan/make/mesher.h"
#include "core/vdb/openvdb/load.h"
#include "proto/wire/transport.h"
#include "tests/client/cutting_proxy.h"
#include "tests/server/service_fixture.h"

namespace tet::test {
namespace {

constexpr std::uint64_t kNoLimit = ~std::uint64_t{0};

bool same_bytes(std::span<const std::byte> a, std::span<const std::byte> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end());
}

bool same_mesh(const TetMesh& a, const TetMesh& b) {
  return a.header.tet_count == b.header.tet_count && a.header.origin == b.header.origin &&
         same_bytes(a.positions.bytes(), b.positions.bytes()) &&
         same_bytes(a.tets.bytes(), b.tets.bytes()) &&
         a.header.has_regions == b.header.has_regions &&
         same_bytes(a.regions.bytes(), b.regions.bytes());
}

class MeshClientTest : public ServiceTest {
 protected:
  MeshClientTest() { start(); }

  MeshResult mesh_here(const std::string& path, const MeshRequest& request) {
    TaskPool pool(1);
    auto volume = load_volume(path, "");
    EXPECT_TRUE(volume.ok()) << volume.status();
    auto result = mesh_volume(
        pool,
        {.shape = std::make_shared<const Volume>(*std::move(volume)), .request = request});
    EXPECT_TRUE(result.ok()) << result.status();
    return *std::move(result);
  }

  MeshResult uniform_mesh_here(int radius) {
    MeshRequest request;
    request.levels = 0;
    return mesh_here(ball_file(radius), request);
  }
};

TEST_F(MeshClientTest, ReceivesTheBytesThatAreMadeInProcess) {
  const auto streamed = client_->stream_mesh(uniform_ball(16), {}, never_);
  ASSERT_TRUE(streamed.ok()) << streamed.status();
  const MeshResult here = uniform_mesh_here(16);
  EXPECT_TRUE(same_mesh(streamed->mesh, here.mesh));
  EXPECT_EQ(streamed->quality.volume, here.quality.volume);
  EXPECT_EQ(streamed->quality.histogram, here.quality.histogram);
}

TEST_F(MeshClientTest, ReceivesGradedMeshesToo) {
  v1::MeshRequest request = uniform_ball(16);
  request.clear_levels();
  const auto streamed = client_->stream_mesh(request, {}, never_);
  ASSERT_TRUE(streamed.ok()) << streamed.status();
  MeshRequest here;
  here.levels = default_levels(Sizing());
  EXPECT_TRUE(same_mesh(streamed->mesh, mesh_here(ball_file(16), here).mesh));
}

TEST_F(MeshClientTest, ReceivesBothSidesAndTheirRegions) {
  const auto streamed = client_->stream_mesh(both_sides_of_ball(16, 2), {}, never_);
  ASSERT_TRUE(streamed.ok()) << streamed.status();
  MeshRequest request;
  request.levels = default_levels(Sizing());
  request.preset = Preset::kBothSides;
  request.box = {{-2, -2, -2}, {2, 2, 2}};
  const MeshResult here = mesh_here(ball_file(16), request);
  EXPECT_TRUE(streamed->mesh.header.has_regions);
  EXPECT_TRUE(same_mesh(streamed->mesh, here.mesh));
  EXPECT_TRUE(streamed->boundary == here.boundary);
}

/// The boundary as it is measured on the mesh that was received.
BoundaryTopology measured(const StreamedMesh& streamed) {
  BoundaryTopology boundary = measure_inside_boundary(streamed.mesh);
  boundary.restored_nodes = streamed.boundary ? streamed.boundary->restored_nodes : 0;
  return boundary;
}

TEST_F(MeshClientTest, IsToldTheBoundaryOfWhatItReceives) {
  for (const std::string kind : {"sphere", "torus", "gyroid", "random-signs"}) {
    SCOPED_TRACE(kind);
    const auto streamed = client_->stream_mesh(mesh_of(solid_file(kind, 0.08)), {}, never_);
    ASSERT_TRUE(streamed.ok()) << streamed.status();
    ASSERT_TRUE(streamed->boundary);
    EXPECT_TRUE(*streamed->boundary == measured(*streamed));
    EXPECT_GT(streamed->boundary->triangles, 1000U);
  }
}

TEST_F(MeshClientTest, ReceivesTheManifoldThatIsMadeInProcess) {
  const std::string path = solid_file("random-signs", 0.08);
  v1::MeshRequest wire_request = mesh_of(path);
  wire_request.set_manifold(true);
  const auto streamed = client_->stream_mesh(wire_request, {}, never_);
  ASSERT_TRUE(streamed.ok()) << streamed.status();
  MeshRequest request;
  request.levels = default_levels(Sizing());
  request.manifold = true;
  EXPECT_TRUE(same_mesh(streamed->mesh, mesh_here(path, request).mesh));
  ASSERT_TRUE(streamed->boundary);
  EXPECT_GT(streamed->boundary->restored_nodes, 0U);
  EXPECT_EQ(streamed->boundary->non_manifold_edges, 0U);
  EXPECT_EQ(streamed->boundary->non_manifold_vertices, 0U);
  EXPECT_TRUE(*streamed->boundary == measured(*streamed));
}

TEST_F(MeshClientTest, ReceivesWhatTheMeshSaysOfThinWalls) {
  const std::string path = folder_.file("gyroid.vdb");
  write_fixture("gyroid", 0.1, path);
  const auto name = client_->upload_file(path, {}, never_);
  ASSERT_TRUE(name.ok()) << name.status();
  v1::MeshRequest request;
  request.set_name(*name);
  const auto streamed = client_->stream_mesh(request, {}, never_);
  ASSERT_TRUE(streamed.ok()) << streamed.status();
  const ThinWalls here = mesh_here(path, {}).thin_walls;
  ASSERT_TRUE(here.any()) << "where the ball cuts the sheet";
  EXPECT_EQ(streamed->thin_walls.inside, here.inside);
  EXPECT_EQ(streamed->thin_walls.outside, here.outside);
  EXPECT_EQ(streamed->thin_walls.suggested_spacing, here.suggested_spacing);
  ASSERT_EQ(streamed->thin_walls.regions.size(), here.regions.size());
  EXPECT_EQ(streamed->thin_walls.regions[0].box.max, here.regions[0].box.max);
}

TEST_F(MeshClientTest, MendsAConnectionThatBreaksAgainAndAgain) {
  const v1::MeshRequest ball = uniform_ball(16);
  CuttingProxy proxy(server_->port(), kNoLimit, 2'500'000);
  const auto client =
      MeshClient::connect(proxy.address(), {.attempts = 6, .first_backoff_ms = 10});
  const auto streamed = client->stream_mesh(ball, {}, never_);
  ASSERT_TRUE(streamed.ok()) << streamed.status();
  EXPECT_GT(proxy.cuts(), 0);
  EXPECT_TRUE(same_mesh(streamed->mesh, uniform_mesh_here(16).mesh));
  EXPECT_GE(streamed->quality.min_dihedral_deg, 11.3);
}

TEST_F(MeshClientTest, BeginsASessionAgainWhoseConnectionBreaksBeforeItsFirstMeshHasCome) {
  const v1::MeshRequest ball = uniform_ball(16);
  const auto whole = client_->stream_mesh(ball, {}, never_);
  ASSERT_TRUE(whole.ok()) << whole.status();
  const std::uint64_t bytes =
      whole->mesh.positions.bytes().size() + whole->mesh.tets.bytes().size();
  // Enough for one mesh, and not for the next one on the same connection.
  CuttingProxy proxy(server_->port(), kNoLimit, bytes * 3 / 2);
  const auto client =
      MeshClient::connect(proxy.address(), {.attempts = 6, .first_backoff_ms = 10});
  ASSERT_TRUE(client->stream_mesh(ball, {}, never_).ok());
  ASSERT_EQ(proxy.cuts(), 0);
  int cuts = 0;
  for (const SessionIds ids : {SessionIds::kInOrder, SessionIds::kStable}) {
    const auto session = client->begin_session(ball, never_, ids);
    ASSERT_TRUE(session.ok()) << session.status();
    EXPECT_EQ(proxy.cuts(), ++cuts);
    EXPECT_EQ((*session)->mesh().mesh_id, whole->mesh_id);
    if (ids == SessionIds::kInOrder) {
      EXPECT_TRUE(same_mesh((*session)->mesh().mesh, whole->mesh));
    }
    EXPECT_EQ((*session)->end(), absl::OkStatus());
  }
}

TEST_F(MeshClientTest, UpdatesAMeshToTheBytesOfAWholeOne) {
  const v1::MeshRequest sphere = mesh_of(solid_file("sphere", 0.04));
  const v1::MeshRequest cavity = mesh_of(solid_file("cavity", 0.04));
  const auto earlier = client_->stream_mesh(sphere, {}, never_);
  const auto whole = client_->stream_mesh(cavity, {}, never_);
  ASSERT_TRUE(earlier.ok() && whole.ok()) << earlier.status() << whole.status();
  const auto updated = client_->update_mesh(cavity, *earlier, {}, never_);
  ASSERT_TRUE(updated.ok()) << updated.status();
  EXPECT_TRUE(same_mesh(updated->mesh, whole->mesh));
  EXPECT_EQ(updated->mesh_id, whole->mesh_id);
  std::uint64_t measured = 0;
  for (const std::uint64_t angles : updated->quality.histogram) measured += angles;
  EXPECT_GT(measured, 0U);
  EXPECT_LT(measured, 6 * whole->mesh.header.tet_count) << "everything was sent";
  const auto packed = client_->update_mesh(cavity, *earlier, {}, never_,
                                           {.encoding = v1::ENCODING_PACKED, .used = {}});
  ASSERT_TRUE(packed.ok()) << packed.status();
  EXPECT_TRUE(same_mesh(packed->mesh, whole->mesh));
  EXPECT_EQ(packed->quality.histogram, updated->quality.histogram);
}

TEST_F(MeshClientTest, UpdatesAMeshWhoseGridIsGoneByTheWholeOne) {
  const v1::MeshRequest sphere = mesh_of(solid_file("sphere", 0.08));
  const auto whole = client_->stream_mesh(sphere, {}, never_);
  ASSERT_TRUE(whole.ok()) << whole.status();
  StreamedMesh lost;
  lost.mesh_id = "lost";
  lost.canonical_request = whole->canonical_request;
  lost.canonical_request.set_name("grids/" + std::string(64, '0'));
  const auto updated = client_->update_mesh(sphere, lost, {}, never_);
  ASSERT_TRUE(updated.ok()) << updated.status();
  EXPECT_TRUE(same_mesh(updated->mesh, whole->mesh));
}

TEST_F(MeshClientTest, BeginsAnUpdateAgainWhereTheBaseIsThereAtOneAttemptAlone) {
  const v1::MeshRequest sphere = mesh_of(solid_file("sphere", 0.04));
  const v1::StreamMeshRequest plain = stream_of(mesh_of(solid_file("cavity", 0.04)));
  const auto earlier = client_->stream_mesh(sphere, {}, never_);
  const auto whole = client_->stream_mesh(plain.mesh(), {}, never_);
  ASSERT_TRUE(earlier.ok() && whole.ok()) << earlier.status() << whole.status();
  v1::StreamMeshRequest beside = plain;
  beside.set_base_mesh_id(earlier->mesh_id);
  beside.set_base_name(sphere.name());
  const auto events_of = [&](const v1::StreamMeshRequest& request) {
    grpc::ClientContext context;
    const auto reader = meshes_->StreamMesh(&context, request);
    std::vector<v1::MeshEvent> events;
    for (v1::MeshEvent event; reader->Read(&event);) {
      if (!event.has_progress()) events.push_back(event);
    }
    EXPECT_TRUE(reader->Finish().ok());
    return events;
  };
  const std::vector<v1::MeshEvent> chunks = events_of(plain), patches = events_of(beside);
  ASSERT_GT(std::min(chunks.size(), patches.size()), 3U);
  ASSERT_TRUE(patches[0].header().has_kept());
  for (const auto& [first, then] : {std::pair(patches, chunks), std::pair(chunks, patches)}) {
    MeshReceiver receiver(&earlier->mesh);
    for (const std::size_t i : {0, 1, 2}) ASSERT_EQ(receiver.take(first[i]), absl::OkStatus());
    const absl::Status other = receiver.take(then[0]);
    EXPECT_EQ(other.code(), absl::StatusCode::kUnavailable) << other;
    EXPECT_EQ(receiver.next_chunk(), 0U);
    EXPECT_EQ(receiver.mesh_id(), whole->mesh_id);
    for (const v1::MeshEvent& event : then) ASSERT_EQ(receiver.take(event), absl::OkStatus());
    ASSERT_TRUE(receiver.complete());
    const auto mesh = std::move(receiver).finish(never_);
    ASSERT_TRUE(mesh.ok()) << mesh.status();
    EXPECT_TRUE(same_mesh(mesh->mesh, whole->mesh));
  }
  // Only where a base was asked for: else it is another mesh.
  MeshReceiver receiver;
  ASSERT_EQ(receiver.take(chunks[0]), absl::OkStatus());
  EXPECT_EQ(receiver.take(patches[0]).code(), absl::StatusCode::kDataLoss);
}

TEST_F(MeshClientTest, GoesOnWithAWholeMeshThoughItsBaseIsThereAgain) {
  const std::string file = solid_file("sphere", 0.04);
  const v1::MeshRequest sphere = mesh_of(file);
  const v1::MeshRequest cavity = mesh_of(solid_file("cavity", 0.04));
  const auto earlier = client_->stream_mesh(sphere, {}, never_);
  const auto whole = client_->stream_mesh(cavity, {}, never_);
  ASSERT_TRUE(earlier.ok() && whole.ok()) << earlier.status() << whole.status();
  const std::string digest = sphere.name().substr(sphere.name().find('/') + 1);
  std::vector<std::filesystem::path> stored;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(config_.store)) {
    const bool is_of_it = entry.path().string().find(digest) != std::string::npos;
    if (is_of_it && entry.is_regular_file()) stored.push_back(entry.path());
  }
  ASSERT_FALSE(stored.empty());
  for (const auto& path : stored) std::filesystem::remove(path);
  restart();
  const std::uint64_t bytes =
      whole->mesh.positions.bytes().size() + whole->mesh.tets.bytes().size();
  CuttingProxy proxy(server_->port(), kNoLimit, bytes * 3 / 4);
  const auto client =
      MeshClient::connect(proxy.address(), {.attempts = 6, .first_backoff_ms = 10});
  std::vector<std::uint64_t> received;
  ClientProgress progress;
  progress.tets = [&](std::uint64_t done, std::uint64_t) {
    received.push_back(done);
    if (received.size() > 1) return;
    EXPECT_EQ(*client_->upload_file(file, {}, never_), sphere.name());
  };
  const auto updated = client->update_mesh(cavity, *earlier, progress, never_);
  ASSERT_TRUE(updated.ok()) << updated.status();
  EXPECT_TRUE(same_mesh(updated->mesh, whole->mesh));
  EXPECT_GE(proxy.cuts(), 1);
  EXPECT_TRUE(std::ranges::is_sorted(received)) << "it began anew";
}

TEST_F(MeshClientTest, UploadsOverABreakingConnectionWithoutSendingTwiceWhatArrived) {
  std::string bytes;
  bytes.resize(12'000'000, 'x');
  const std::string big = folder_.write("big", bytes);
  CuttingProxy proxy(server_->port(), 7'000'000, kNoLimit);
  const auto client =
      MeshClient::connect(proxy.address(), {.attempts = 6, .first_backoff_ms = 10});
  int first_pieces = 0;
  ClientProgress progress;
  progress.upload = [&](std::uint64_t done, std::uint64_t) {
    first_pieces += done == std::uint64_t{kUploadPieceBytes};
  };
  const auto name = client->upload_file(big, progress, never_);
  ASSERT_TRUE(name.ok()) << name.status();
  EXPECT_GT(proxy.cuts(), 0);
  EXPECT_EQ(first_pieces, 1);
  EXPECT_EQ(client_->list_grids(never_)->front().size_bytes(), 12'000'000);
}

TEST_F(MeshClientTest, SendsAStoredFileOnce) {
  std::uint64_t sent = 0;
  ClientProgress progress;
  progress.upload = [&](std::uint64_t done, std::uint64_t) { sent = done; };
  ASSERT_TRUE(client_->upload_file(ball_file(8), progress, never_).ok());
  EXPECT_EQ(sent, std::filesystem::file_size(ball_file(8)));
  sent = 0;
  ASSERT_TRUE(client_->upload_file(ball_file(8), progress, never_).ok());
  EXPECT_EQ(sent, 0U);
}

TEST_F(MeshClientTest, StopsSoonAfterACancellation) {
  const v1::MeshRequest ball = uniform_ball(48);  // 75 MB: more than can be on its way
  Cancellation cancellation;
  ClientProgress progress;
  progress.tets = [&](std::uint64_t done, std::uint64_t) {
    if (done > 0) cancellation.cancel();
  };
  const auto streamed = client_->stream_mesh(ball, progress, cancellation);
  EXPECT_EQ(streamed.status().code(), absl::StatusCode::kCancelled);
  EXPECT_TRUE(work_stops());
}

TEST_F(MeshClientTest, KeepsTheServersRefusal) {
  v1::MeshRequest request;
  request.set_name("grids/" + std::string(64, '0'));
  EXPECT_EQ(client_->stream_mesh(request, {}, never_).status().code(),
            absl::StatusCode::kNotFound);
}

TEST_F(MeshClientTest, GivesUpOnAServerThatIsNotThere) {
  const auto client =
      MeshClient::connect("127.0.0.1:1", {.attempts = 2, .first_backoff_ms = 10});
  EXPECT_EQ(client->list_grids(never_).status().code(), absl::StatusCode::kUnavailable);
}

TEST_F(MeshClientTest, RefusesAFileThatIsNotThere) {
  EXPECT_EQ(client_->upload_file("/nowhere.vdb", {}, never_).status().code(),
            absl::StatusCode::kNotFound);
}

/// A header of two vertices in one chunk.
v1::MeshEvent small_header() {
  v1::MeshEvent event;
  event.mutable_header()->set_mesh_id("m");
  event.mutable_header()->set_vertex_count(2);
  event.mutable_header()->set_chunk_count(1);
  event.mutable_header()->set_coordinate_type(v1::COORDINATE_TYPE_FLOAT32);
  event.mutable_header()->set_index_type(v1::INDEX_TYPE_UINT32);
  return event;
}

v1::MeshEvent small_chunk() {
  v1::MeshEvent event;
  event.mutable_chunk()->set_vertex_count(2);
  event.mutable_chunk()->set_positions(std::string(24, '\1'));
  event.mutable_chunk()->set_checksum(0x550f07d3);
  return event;
}

TEST(MeshReceiver, RefusesBytesThatWereChanged) {
  MeshReceiver receiver;
  ASSERT_TRUE(receiver.take(small_header()).ok());
  v1::MeshEvent changed = small_chunk();
  changed.mutable_chunk()->mutable_positions()->at(7) = '\2';
  EXPECT_EQ(receiver.take(changed).code(), absl::StatusCode::kDataLoss);
  EXPECT_TRUE(receiver.take(small_chunk()).ok());
}

TEST(MeshClient, LeavesGrpcRunningWhenTheLastOneGoes) {
  // Whoever let go of it otherwise might wait ten seconds for its end.
  EXPECT_NE(MeshClient::connect("127.0.0.1:1"), nullptr);
  EXPECT_TRUE(grpc_is_initialized());
}

TEST(MeshReceiver, RefusesChunksOutOfPlace) {
  MeshReceiver receiver;
  EXPECT_FALSE(receiver.take(small_chunk()).ok());
  ASSERT_TRUE(receiver.take(small_header()).ok());
  v1::MeshEvent beyond = small_chunk();
  beyond.mutable_chunk()->set_index(1);
  EXPECT_FALSE(receiver.take(beyond).ok());
  beyond = small_chunk();
  beyond.mutable_chunk()->set_vertex_count(3);
  EXPECT_FALSE(receiver.take(beyond).ok());
}

TEST(MeshReceiver, RefusesRegionsThatWereNotAnnounced) {
  MeshReceiver receiver;
  ASSERT_TRUE(receiver.take(small_header()).ok());
  v1::MeshEvent chunk = small_chunk();
  chunk.mutable_chunk()->set_regions("\1");
  EXPECT_EQ(receiver.take(chunk).code(), absl::StatusCode::kDataLoss);
}

TEST(MeshReceiver, RefusesPartsThatAreNotAllOfTheMesh) {
  const auto taken = [](const std::vector<std::pair<std::int64_t, std::int64_t>>& vertices,
                        const std::string& name = "femur") {
    v1::MeshEvent event = small_header();
    for (const auto& [first, count] : vertices) {
      v1::MeshPart& part = *event.mutable_header()->add_parts();
      part.set_name(name);
      part.set_first_vertex(first);
      part.set_vertex_count(count);
    }
    return MeshReceiver().take(event).code();
  };
  constexpr auto kLost = absl::StatusCode::kDataLoss;
  EXPECT_EQ(taken({{0, 1}, {1, 1}}), absl::StatusCode::kOk);
  EXPECT_EQ(taken({{0, 1}}), kLost);
  EXPECT_EQ(taken({{0, 1}, {0, 1}}), kLost);
  EXPECT_EQ(taken({{0, 3}, {3, -1}}), kLost);
  EXPECT_EQ(taken({{0, 1}, {1, 1}}, ""), kLost);
  EXPECT_EQ(taken({{0, 1}, {1, 1}}, "a\nb"), kLost);
  std::vector<std::pair<std::int64_t, std::int64_t>> many(65, {2, 0});
  many.front() = {0, 2};
  EXPECT_EQ(taken(many), kLost);
}

TEST(MeshReceiver, RefusesABoundaryWithImpossibleCounts) {
  MeshReceiver receiver;
  ASSERT_TRUE(receiver.take(small_header()).ok());
  ASSERT_TRUE(receiver.take(small_chunk()).ok());
  v1::MeshEvent trailer;
  trailer.mutable_trailer()->mutable_boundary()->set_vertices(-1);
  EXPECT_EQ(receiver.take(trailer).code(), absl::StatusCode::kDataLoss);
  EXPECT_FALSE(receiver.complete());
  trailer.mutable_trailer()->mutable_boundary()->set_vertices(2);
  trailer.mutable_trailer()->mutable_boundary()->set_euler_characteristic(-4);
  EXPECT_TRUE(receiver.take(trailer).ok());
  EXPECT_TRUE(receiver.complete());
}

TEST(MeshReceiver, RefusesATrailerBeforeTheLastChunk) {
  MeshReceiver receiver;
  ASSERT_TRUE(receiver.take(small_header()).ok());
  v1::MeshEvent trailer;
  trailer.mutable_trailer();
  EXPECT_EQ(receiver.take(trailer).code(), absl::StatusCode::kDataLoss);
  EXPECT_FALSE(receiver.complete());
}

}  // namespace
}  // namespace tet::test
