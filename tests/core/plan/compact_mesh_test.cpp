#include "core/transfer/compact_mesh.h"

#include <cstddef>
#include <cstring>
#include <limits>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/plan/make/mesher.h"
#include "tests/core/plan/meshing.h"
#include "tests/support/sanitized.h"
#include "tests/support/solids.h"
#include "tests/support/volume_fixtures.h"

namespace tet::compact_mesh_test {
namespace {

using test::same_bytes;
using Bytes = std::vector<std::byte>;

struct Encoded {
  MeshHeader header;
  CompactFrame frame;
  std::vector<Bytes> chunks;

  std::size_t size() const {
    std::size_t bytes = 0;
    for (const Bytes& chunk : chunks) bytes += chunk.size();
    return bytes;
  }
};

Encoded encode(const Volume& volume,
               const MeshRequest& request,
               const MeshLimits& limits = {}) {
  const auto plan = plan_mesh(
      {.shape = std::make_shared<const Volume>(volume), .request = request, .limits = limits});
  EXPECT_TRUE(plan.ok()) << plan.status();
  if (!plan.ok()) return {};
  const BrickPlan& bricks = *as_bricks(**plan);
  Encoded encoded{bricks.header(), compact_frame(bricks), {}};
  MeshWorkspace workspace;
  for (std::uint64_t i = 0; i < encoded.header.chunk_count; ++i) {
    encode_chunk(bricks, i, workspace, encoded.chunks.emplace_back());
  }
  return encoded;
}

absl::StatusOr<FilledMesh> decode(const Encoded& encoded) {
  CompactBricks bricks(encoded.frame.rules.both_sides);
  for (const Bytes& chunk : encoded.chunks) {
    if (absl::Status status = bricks.add(chunk); !status.ok()) return status;
  }
  return decode_mesh(std::move(bricks), encoded.header, encoded.frame, Cancellation());
}

struct Case {
  std::string name;
  Volume volume;
  MeshRequest request;
};

/// Every way in which bricks, rules and numbers differ.
std::vector<Case> cases() {
  MeshRequest graded, uniform, manifold, both_sides, half, coarse, wide;
  uniform.levels = 0;
  manifold.manifold = true;
  both_sides.preset = Preset::kBothSides;
  half.preset = Preset::kBothSides;
  half.box = WorldBox{WorldPoint{-40, -40, -40}, WorldPoint{40, 40, 8}};
  coarse.spacing = 1.4;
  wide.coordinates = CoordinateType::kFloat64;
  wide.indices = IndexType::kUint64;
  std::vector<Case> cases;
  const auto add = [&](const char* name, Volume volume, const MeshRequest& request) {
    cases.push_back({name, std::move(volume), request});
  };
  const int radius = test::sanitized_or(14, 20);
  add("ball, graded", test::ball(test::sanitized_or(20, 30)), graded);
  add("ball, uniform", test::ball(radius), uniform);
  add("ball, wide", test::ball(radius), wide);
  add("ball, other steps", test::ball(radius), coarse);
  add("ball, both sides", test::ball(radius), both_sides);
  add("ball, cut", test::ball(radius), half);
  add("signs", test::random_signs(20, 3), graded);
  add("signs, manifold", test::random_signs(20, 4), manifold);
  add("signs, both sides", test::random_signs(16, 11), both_sides);
  // No node sees the speck, so all that is meshed are coarse leaves around it.
  MeshRequest around;
  around.preset = Preset::kBothSides;
  around.spacing = 2;
  around.levels = 1;
  around.box = WorldBox{WorldPoint{-64, -64, -64}, WorldPoint{64, 64, 64}};
  const auto speck = [](VoxelCoord v) { return v == VoxelCoord{9, 8, 8} ? -0.1F : 1.0F; };
  add("nothing, both sides", test::dense_volume({{-16, -16, -16}, {15, 15, 15}}, 1, speck),
      around);
  return cases;
}

TEST(CompactMesh, IsByteForByteThePlainMesh) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const absl::StatusOr<FilledMesh> decoded = decode(encode(c.volume, c.request));
    ASSERT_TRUE(decoded.ok()) << decoded.status();
    const MeshResult plain = test::mesh(c.volume, c.request);
    EXPECT_TRUE(same_bytes(decoded->mesh, plain.mesh));
    EXPECT_EQ(decoded->quality.min_dihedral_deg, plain.quality.min_dihedral_deg);
    EXPECT_EQ(decoded->quality.volume, plain.quality.volume);
    EXPECT_TRUE(decoded->quality.histogram == plain.quality.histogram);
  }
}

TEST(CompactMesh, HasTheSameChunksWhateverThePlanKept) {
  MeshLimits nothing_kept;
  nothing_kept.kept_geometry_bytes = 0;
  for (const Case& c : test::few_of(cases(), 3)) {
    SCOPED_TRACE(c.name);
    EXPECT_TRUE(encode(c.volume, c.request).chunks ==
                encode(c.volume, c.request, nothing_kept).chunks);
  }
}

TEST(CompactMesh, TakesAtMostFourBytesATetWhereItIsGraded) {
  const int radius = test::sanitized_or(30, 60);
  for (const Volume& volume : {test::ball(radius), test::ball(25), test::random_signs(24, 5)}) {
    const Encoded encoded = encode(volume, {});
    EXPECT_LT(static_cast<double>(encoded.size()),
              4 * static_cast<double>(encoded.header.tet_count));
  }
}

TEST(CompactMesh, RefusesEveryTruncation) {
  Encoded encoded = encode(test::ball(6), {});
  ASSERT_EQ(encoded.chunks.size(), 1U);
  const Bytes whole = encoded.chunks[0];
  for (std::size_t size = 0; size < whole.size(); ++size) {
    encoded.chunks[0].assign(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_EQ(decode(encoded).status().code(), absl::StatusCode::kDataLoss) << size;
  }
}

/// The totals that a server which means its bytes would send: what is left of them, if
/// anything.
bool count_again(Encoded& encoded) {
  CompactBricks bricks(encoded.frame.rules.both_sides);
  for (const Bytes& chunk : encoded.chunks) {
    if (!bricks.add(chunk).ok()) return false;
  }
  const auto counted = std::move(bricks).count(encoded.frame.rules);
  if (!counted.ok()) return false;
  encoded.header.vertex_count = counted->first_vertex(counted->brick_count());
  encoded.header.tet_count = counted->first_tet(counted->brick_count());
  return true;
}

// What a brick's first byte says: docs/wire_format.md.
constexpr std::uint8_t kNextAlongZ = 0, kAnywhere = 2, kInside = 4, kSurface = 8,
                       kHasLeaves = 16;

/// Appends little-endian numbers.
template <class... Numbers>
void append(Bytes& bytes, Numbers... numbers) {
  const auto one = [&](auto number) {
    const auto raw = std::as_bytes(std::span(&number, 1));
    bytes.insert(bytes.end(), raw.begin(), raw.end());
  };
  (one(numbers), ...);
}

void append_full(Bytes& bytes) { append(bytes, std::uint8_t{0}, std::uint8_t{0xff}); }
void append_empty(Bytes& bytes) { append(bytes, std::uint8_t{0xff}, std::uint8_t{0}); }
void append_varint(Bytes& bytes, std::size_t value) {
  for (; value >= 0x80; value >>= 7) append(bytes, static_cast<std::uint8_t>(value | 0x80));
  append(bytes, static_cast<std::uint8_t>(value));
}

TEST(CompactMesh, RefusesLeavesWithGapsWhateverTheHeaderSays) {
  constexpr std::uint8_t kFirstSliceOnly = 0xfe;
  Bytes chunk;
  append(chunk, std::uint8_t{2});  // bricks: one of no use, and a coarse one
  append(chunk, kAnywhere, std::uint8_t{0}, 100, 100, 100);
  append(chunk, static_cast<std::uint8_t>(kAnywhere | kHasLeaves), std::uint8_t{1}, 0, 0, 0);
  append(chunk, kFirstSliceOnly, std::uint8_t{0}, std::uint64_t{1});  // a leaf
  append(chunk, kFirstSliceOnly, std::uint8_t{0},
         std::uint64_t{1} << 8);  // a family never sent
  Encoded gap = encode(test::ball(5), {});
  gap.chunks = {chunk};
  ASSERT_TRUE(count_again(gap));
  ASSERT_GT(gap.header.tet_count, 0U);
  EXPECT_EQ(decode(gap).status().code(), absl::StatusCode::kDataLoss);
}

/// Appends the first brick of a chunk up to its leaves, all of them: at (0, 0, 0).
void append_first(Bytes& chunk, std::uint8_t side) {
  append(chunk, static_cast<std::uint8_t>(kAnywhere | side | kHasLeaves), std::uint8_t{0}, 0, 0,
         0);
  append_full(chunk);
}

/// A brick that is inside, and one that is not, with nothing between them.
Bytes torn_bricks() {
  Bytes chunk;
  append(chunk, std::uint8_t{2});
  append_first(chunk, kInside);
  append(chunk, static_cast<std::uint8_t>(kNextAlongZ | kHasLeaves));
  append_full(chunk);
  return chunk;
}

/// Two such bricks, of which the upper one has the cut points of its own edges.
Bytes half_torn_bricks(bool both_sides, std::size_t cuts) {
  Bytes chunk;
  append(chunk, std::uint8_t{2});
  append_first(chunk, 0);
  append(chunk, static_cast<std::uint8_t>(kNextAlongZ | kSurface | kHasLeaves));
  append_full(chunk);
  for (int kind = 0; kind < kNodeKinds; ++kind) {
    append_full(chunk);   // `+`
    append_empty(chunk);  // zeros
  }
  for (std::size_t shape = 0; both_sides && shape < kTetShapes; ++shape) append_empty(chunk);
  append_varint(chunk, cuts);
  for (std::size_t i = 0; i < cuts; ++i) append(chunk, 0.5F);
  return chunk;
}

TEST(CompactMesh, RefusesCutsWhereNoCutPointIs) {
  for (const Preset preset : {Preset::kDefault, Preset::kBothSides}) {
    MeshRequest request;
    request.preset = preset;
    Encoded torn = encode(test::ball(5), request);
    torn.chunks = {torn_bricks()};
    ASSERT_TRUE(count_again(torn));
    ASSERT_GT(torn.header.tet_count, 0U);
    EXPECT_EQ(decode(torn).status().code(), absl::StatusCode::kDataLoss);

    int counted = 0;
    for (std::size_t cuts = 0; cuts <= kEdgeFamilies * kBrickCells; ++cuts) {
      torn.chunks = {half_torn_bricks(preset == Preset::kBothSides, cuts)};
      if (!count_again(torn)) continue;
      ++counted;
      ASSERT_GT(torn.header.tet_count, 0U);
      EXPECT_EQ(decode(torn).status().code(), absl::StatusCode::kDataLoss) << cuts;
    }
    EXPECT_EQ(counted, 1) << "so many cuts as the signs ask for";
  }
}

TEST(CompactMesh, RefusesFractionsThatAreNone) {
  Encoded encoded = encode(test::ball(5), {});
  Bytes& chunk = encoded.chunks[0];
  const float nothing = std::numeric_limits<float>::quiet_NaN();
  int refused = 0;
  for (std::size_t at = 0; at + sizeof(nothing) <= chunk.size(); at += 97) {
    const Bytes before = chunk;
    std::memcpy(&chunk[at], &nothing, sizeof(nothing));
    const auto decoded = decode(encoded);
    refused += !decoded.ok();
    chunk = before;
  }
  EXPECT_GT(refused, 0);
}

TEST(CompactMesh, RefusesOrSurvivesAnyWrongByte) {
  for (const bool both_sides : {false, true}) {
    MeshRequest request;
    if (both_sides) request.preset = Preset::kBothSides;
    Encoded encoded = encode(test::ball(5), request);
    std::mt19937 random(7);
    for (int i = 0; i < test::sanitized_or(100, 300); ++i) {
      Bytes& chunk = encoded.chunks[random() % encoded.chunks.size()];
      std::byte& byte = chunk[random() % chunk.size()];
      const std::byte before = byte;
      byte ^= std::byte{1} << random() % 8;
      const auto decoded = decode(encoded);  // a flipped fraction bit makes another mesh
      if (!decoded.ok()) {
        EXPECT_EQ(decoded.status().code(), absl::StatusCode::kDataLoss);
      }
      byte = before;
    }
  }
}

}  // namespace
}  // namespace tet::compact_mesh_test
