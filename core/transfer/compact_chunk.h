// A chunk without what the rules imply: leaves, signs and cut fractions of its bricks instead
// of positions and tets. docs/wire_format.md has it byte by byte.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/mesh/lattice_to_world.h"
#include "core/plan/brick/brick_plan.h"
#include "core/stuffing/stuffing_rules.h"

namespace tet {

/// What compact chunks leave out because all of them share it: where the lattice of their mesh
/// lies, and how it was stuffed.
struct CompactFrame {
  LatticeToWorld to_world;
  StuffingRules rules;
};

CompactFrame compact_frame(const BrickPlan& plan);

/// Appends one chunk of a plan to `bytes`. They depend on (shape, request, index) alone.
void encode_chunk(const BrickPlan& plan,
                  std::uint64_t index,
                  MeshWorkspace& workspace,
                  std::vector<std::byte>& bytes);

/// What compact chunks say of a mesh, gathered in the order of the chunks.
class CompactBricks {
 public:
  explicit CompactBricks(bool both_sides) : both_sides_(both_sides) {}

  /// Adds one chunk. Errors: kDataLoss (bytes that no encoder writes); nothing can be added
  /// after one.
  absl::Status add(std::span<const std::byte> chunk);

  /// The mesh that all chunks together make. Errors: kDataLoss (geometry that does not fit the
  /// signs).
  absl::StatusOr<CountedMesh> count(const StuffingRules& rules, bool faces = false) &&;

  /// Bricks of the chunks added so far, chunk by chunk, from 0 on.
  const std::vector<std::size_t>& first_brick() const noexcept { return first_brick_; }

 private:
  class Reader;
  absl::Status add_brick(Reader& reader);
  absl::Status add_surface(Reader& reader);

  bool both_sides_;
  std::vector<std::size_t> first_brick_{0};
  std::vector<OctreeLevel> levels_;
  // Surface bricks have these until all are there: cut edges take most of a StuffedBrick.
  struct Signs {
    NodeMasks plus, zero;
  };
  std::vector<Signs> signs_;
  std::vector<std::size_t> geometry_sizes_;  ///< bytes
  MeshStructure structure_;
};

}  // namespace tet
