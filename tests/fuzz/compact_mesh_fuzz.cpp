// Compact chunks that no server wrote: refused, or a mesh whose every id is a vertex.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <utility>

#include "core/transfer/compact_mesh.h"
#include "tests/fuzz/fuzz_target.h"

namespace tet::compact_mesh_fuzz {
namespace {

/// More would only be slower.
constexpr std::uint64_t kMaxTets = 200'000;

constexpr std::uint8_t kBothSides = 1, kWideIds = 2;

absl::StatusOr<CompactBricks> read(std::span<const std::byte> chunk, bool both_sides) {
  CompactBricks bricks(both_sides);
  if (absl::Status status = bricks.add(chunk); !status.ok()) return status;
  return bricks;
}

/// The header that a server would have sent for these bricks.
absl::StatusOr<MeshHeader> count(CompactBricks bricks, const StuffingRules& rules) {
  const absl::StatusOr<CountedMesh> counted = std::move(bricks).count(rules);
  if (!counted.ok()) return counted.status();
  MeshHeader header;
  header.vertex_count = counted->first_vertex(counted->brick_count());
  header.tet_count = counted->first_tet(counted->brick_count());
  header.has_regions = rules.both_sides;
  return header;
}

void expect_ids_of_vertices(const TetMesh& mesh) {
  for (std::uint64_t i = 0; i < mesh.header.tet_count; ++i) {
    for (const std::uint64_t v : mesh.tet(i)) {
      if (v >= mesh.header.vertex_count) std::abort();
    }
  }
}

}  // namespace

TET_FUZZ_TARGET(compact_mesh_fuzz) {
  if (size == 0) return 0;
  const auto chunk = std::as_bytes(std::span(data + 1, size - 1));
  CompactFrame frame;
  frame.rules.both_sides = (data[0] & kBothSides) != 0;
  auto bricks = read(chunk, frame.rules.both_sides);
  if (!bricks.ok()) return 0;
  auto header = count(*std::move(bricks), frame.rules);
  if (!header.ok() || header->tet_count > kMaxTets || header->vertex_count > kMaxTets) return 0;
  header->index_type = (data[0] & kWideIds) != 0 ? IndexType::kUint64 : IndexType::kUint32;
  auto again = read(chunk, frame.rules.both_sides);
  const auto decoded = decode_mesh(*std::move(again), *header, frame, Cancellation());
  if (decoded.ok()) expect_ids_of_vertices(decoded->mesh);
  return 0;
}

}  // namespace tet::compact_mesh_fuzz
