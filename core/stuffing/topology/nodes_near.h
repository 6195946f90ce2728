// The signs of the nodes near each cell of a brick, so that all cells are looked at at once.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "core/base/brick_mask.h"
#include "core/lattice/bcc.h"

namespace tet {

/// Slices of 8 x 8 nodes, from x = -1 to 8: bit y*8 + z.
using NodeColumn = std::array<std::uint64_t, 10>;

/// Signs of nodes near the cells of a brick: of each kind, a column for each pair of steps
/// along y and z to the nodes from the cells.
struct NodesNear {
  static constexpr std::array<std::array<int, 2>, 6> kCornerSteps{
      {{0, 0}, {0, 1}, {1, 0}, {1, 1}, {0, -1}, {-1, 0}}};
  static constexpr std::array<std::array<int, 2>, 9> kCentreSteps{
      {{0, 0}, {0, 1}, {1, 0}, {0, -1}, {-1, 0}, {1, 1}, {1, -1}, {-1, 1}, {-1, -1}}};
  static constexpr std::size_t kColumns = kCornerSteps.size() + kCentreSteps.size();

  std::array<NodeColumn, kColumns> plus, zero;

  /// The sets are valid for nodes in [-1, 8]^3.
  NodesNear(const std::array<HaloSet, kNodeKinds>& all_plus,
            const std::array<HaloSet, kNodeKinds>& all_zero) noexcept;
};

/// Where NodesNear says something of the node of a kind that is some steps on from each cell.
struct NodePlace {
  std::size_t column = NodesNear::kColumns;
  int x = 0;

  constexpr NodePlace() = default;
  constexpr NodePlace(NodeKind kind, LatticeCoord steps) : x(steps.x) {
    const auto find = [&](const auto& columns, std::size_t first) {
      for (std::size_t c = 0; c < columns.size(); ++c) {
        if (columns[c][0] == steps.y && columns[c][1] == steps.z) column = first + c;
      }
    };
    if (kind == kCorner) {
      find(NodesNear::kCornerSteps, 0);
    } else {
      find(NodesNear::kCentreSteps, NodesNear::kCornerSteps.size());
    }
  }

  /// Eight slices of cells.
  const std::uint64_t* in(
      const std::array<NodeColumn, NodesNear::kColumns>& nodes) const noexcept {
    return nodes[column].data() + 1 + x;
  }
};

/// One bit for each cell of a brick, as a vector. Passed by reference and always inlined: what
/// a vector is passed in depends on the processor.
using CellBits [[gnu::vector_size(64)]] = std::uint64_t;

[[gnu::always_inline]] inline void load_bits(const std::uint64_t* slices,
                                             CellBits& bits) noexcept {
  std::memcpy(&bits, slices, sizeof(bits));
}
[[gnu::always_inline]] inline void store_bits(const CellBits& bits, BrickMask& mask) noexcept {
  std::memcpy(mask.slice.data(), &bits, sizeof(bits));
}

}  // namespace tet
