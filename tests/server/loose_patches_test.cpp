// Patches of sessions with nothing in them that the client has; and servers that lie about
// them.
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "client/library/mesh_receiver.h"
#include "client/library/stable_chunks.h"
#include "core/base/parallel.h"
#include "core/vdb/openvdb/load.h"
#include "proto/wire/checksum.h"
#include "tests/core/plan/meshing.h"
#include "tests/server/session_fixture.h"
#include "tests/support/sanitized.h"

namespace tet::test {
namespace {

using Events = std::vector<v1::MeshEvent>;

class LoosePatchesTest : public RemeshSessionTest {
 protected:
  /// What a session tells of a torus and then of one with a few other leaves, frame by frame.
  std::vector<Events> frames(bool loose) {
    const std::string path = solid_file("torus", 0.05);
    const Volume volume = load_volume(path, "").value();
    std::vector<v1::RemeshRequest> messages(2);
    *messages[0].mutable_start() = mesh_of(path);
    messages[0].set_loose_patches(loose);
    for (const std::size_t brick : {volume.bricks.size() / 2, volume.bricks.size() / 3}) {
      *messages[1].mutable_frame()->add_leaves() = inflated(volume, brick);
    }
    std::vector<Events> frames;
    for (v1::MeshEvent& event : events_after(messages)) {
      if (event.has_header()) frames.emplace_back();
      if (!frames.empty() && !event.has_progress()) frames.back().push_back(std::move(event));
    }
    return frames;
  }
};

/// Why a receiver does not take a frame; or OK, where it is whole.
template <class Receiver>
absl::Status taken(Receiver& receiver, const Events& events) {
  for (const v1::MeshEvent& event : events) {
    if (absl::Status status = receiver.take(event); !status.ok()) return status;
  }
  return receiver.complete() ? absl::OkStatus() : absl::InternalError("it is not whole");
}

TetMesh mesh_of_events(const Events& events,
                       const TetMesh* base = nullptr,
                       bool loose = false) {
  MeshReceiver receiver(base, {}, loose);
  const absl::Status status = taken(receiver, events);
  EXPECT_TRUE(status.ok()) << status;
  return std::move(std::move(receiver).finish({})->mesh);
}

std::size_t bytes_of(const Events& events) {
  std::size_t bytes = 0;
  for (const v1::MeshEvent& event : events) bytes += event.ByteSizeLong();
  return bytes;
}

TEST_F(LoosePatchesTest, MakeTheSameMeshOfFewerBytes) {
  start();
  const std::vector<Events> loose = frames(true), tight = frames(false);
  ASSERT_EQ(loose.size(), 2U);
  ASSERT_EQ(tight.size(), 2U);
  const v1::KeptParts& kept = loose[1][0].header().kept();
  EXPECT_TRUE(kept.loose());
  EXPECT_EQ(kept.vertices_size() + kept.tets_size(), 0);
  const TetMesh base = mesh_of_events(loose[0]);
  EXPECT_TRUE(same_bytes(mesh_of_events(tight[0]), base));
  EXPECT_TRUE(
      same_bytes(mesh_of_events(loose[1], &base, true), mesh_of_events(tight[1], &base)));
  EXPECT_LT(bytes_of(loose[1]), bytes_of(tight[1]) * 2 / 3);
}

TEST_F(LoosePatchesTest, AreForThoseWhoSayThatTheyKnowThem) {
  start();
  const std::vector<Events> tight = frames(false);
  ASSERT_EQ(tight.size(), 2U);
  const v1::KeptParts& kept = tight[1][0].header().kept();
  EXPECT_FALSE(kept.loose());
  EXPECT_EQ(kept.vertex_runs_size() + kept.tet_runs_size(), 0);
  EXPECT_GT(kept.tets_size(), 0);
}

TEST_F(LoosePatchesTest, AreRefusedByThoseWhoAskedForNone) {
  start();
  const std::vector<Events> loose = frames(true);
  const TetMesh base = mesh_of_events(loose[0]);
  MeshReceiver receiver(&base);
  EXPECT_EQ(taken(receiver, loose[1]).code(), absl::StatusCode::kDataLoss);
}

/// Feeds a frame after the first one to whoever makes a mesh of it.
void expect_lost(const Events& first, const TetMesh& base, const Events& lie) {
  MeshReceiver receiver(&base, {}, true);
  EXPECT_EQ(taken(receiver, lie).code(), absl::StatusCode::kDataLoss);
  StableMesh stable;
  StableChunks chunks(stable);
  StreamReader whole(chunks, StreamReader::Base::kNone);
  ASSERT_TRUE(taken(whole, first).ok());
  StreamReader next(chunks, StreamReader::Base::kFrame);
  EXPECT_EQ(taken(next, lie).code(), absl::StatusCode::kDataLoss);
}

v1::KeptParts& kept_in(Events& events) {
  return *events.front().mutable_header()->mutable_kept();
}

/// The first tet has a vertex that there is not.
void refer_beyond(Events& events) {
  const auto vertices = static_cast<std::uint32_t>(events.front().header().vertex_count());
  v1::MeshChunk& chunk = *events.at(1).mutable_chunk();
  std::memcpy(chunk.mutable_tets()->data(), &vertices, sizeof(vertices));
  std::uint32_t checksum = add_to_checksum(0, std::as_bytes(std::span(chunk.positions())));
  checksum = add_to_checksum(checksum, std::as_bytes(std::span(chunk.tets())));
  chunk.set_checksum(checksum);
}

TEST_F(LoosePatchesTest, AreRefusedWhereTheyDoNotFit) {
  start();
  const std::vector<Events> loose = frames(true);
  ASSERT_EQ(loose.size(), 2U);
  ASSERT_GT(loose[1].size(), 3U) << "a header, two chunks, a trailer";
  const TetMesh base = mesh_of_events(loose[0]);
  const auto add_to = [](auto* numbers, int i, std::uint64_t more) {
    numbers->Set(i, numbers->Get(i) + more);
  };
  const auto chunk = [](Events& events) -> v1::MeshChunk& {
    return *events.at(1).mutable_chunk();
  };
  const std::vector<std::pair<std::string, std::function<void(Events&)>>> lies{
      {"not loose", [](Events& e) { kept_in(e).set_loose(false); }},
      {"one tet more is kept", [&](Events& e) { add_to(kept_in(e).mutable_tet_runs(), 2, 1); }},
      {"one less is", [&](Events& e) { add_to(kept_in(e).mutable_tet_runs(), 2, ~0ULL); }},
      {"a vertex less is",
       [&](Events& e) { add_to(kept_in(e).mutable_vertex_runs(), 2, ~0ULL); }},
      {"beyond the mesh",
       [&](Events& e) { add_to(kept_in(e).mutable_vertex_runs(), 2, 1ULL << 40U); }},
      {"beyond the base",
       [&](Events& e) { add_to(kept_in(e).mutable_tet_runs(), 0, 1ULL << 40U); }},
      {"no runs", [](Events& e) { kept_in(e).mutable_tet_runs()->RemoveLast(); }},
      {"a chunk is missing", [](Events& e) { e.erase(e.begin() + 1); }},
      {"a chunk comes twice", [](Events& e) { e.insert(e.begin() + 1, e[1]); }},
      {"a later vertex", [&](Events& e) { chunk(e).set_first_vertex(1); }},
      {"a later tet", [&](Events& e) { chunk(e).set_first_tet(1); }},
      {"a tet too many", [&](Events& e) { chunk(e).set_tet_count(chunk(e).tet_count() + 1); }},
      {"packed", [&](Events& e) { chunk(e).set_packed("p"); }},
      {"a vertex beyond the mesh", refer_beyond},
  };
  for (const auto& [name, lie] : lies) {
    SCOPED_TRACE(name);
    Events events = loose[1];
    lie(events);
    expect_lost(loose[0], base, events);
  }
}

/// Whatever the runs say, nothing is written or read beyond a column, as sanitizers would tell.
TEST_F(LoosePatchesTest, HarmNobodyWhateverTheirRunsAre) {
  start();
  const std::vector<Events> loose = frames(true);
  ASSERT_EQ(loose.size(), 2U);
  const TetMesh base = mesh_of_events(loose[0]);
  std::mt19937 random(28);
  for (int turn = 0; turn < sanitized_or(20, 60); ++turn) {
    Events events = loose[1];
    for (auto* numbers :
         {kept_in(events).mutable_vertex_runs(), kept_in(events).mutable_tet_runs()}) {
      for (int lies = static_cast<int>(random() % 4); lies > 0; --lies) {
        const int i = static_cast<int>(random() % static_cast<unsigned>(numbers->size()));
        // Two numbers that change by as much leave the totals as they are.
        const std::uint64_t by = random() % 9;
        numbers->Set(i, numbers->Get(i) + by);
        const int other = static_cast<int>(random() % static_cast<unsigned>(numbers->size()));
        if (numbers->Get(other) >= by) numbers->Set(other, numbers->Get(other) - by);
      }
    }
    MeshReceiver receiver(&base, {}, true);
    if (taken(receiver, events).ok()) {
      const auto mesh = std::move(receiver).finish({});
      ASSERT_TRUE(mesh.ok()) << mesh.status();
      EXPECT_TRUE(ids_are_within(mesh->mesh.tets.bytes(), mesh->mesh.header));
    }
    StableMesh stable;
    StableChunks chunks(stable);
    StreamReader whole(chunks, StreamReader::Base::kNone);
    ASSERT_TRUE(taken(whole, loose[0]).ok());
    StreamReader next(chunks, StreamReader::Base::kFrame);
    if (!taken(next, events).ok()) continue;
    EXPECT_TRUE(ids_are_within(stable.slots().tets.bytes(), stable.slots().header));
    TaskPool(1).run([&] { stable.in_order().IgnoreError(); });
  }
}

}  // namespace
}  // namespace tet::test
