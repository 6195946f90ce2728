#include "core/stuffing/brick_geometry.h"

#include "core/base/vector_clones.h"
#include "core/lattice/reach.h"

namespace tet {

MovedAlong moved_along(NodeKind kind, int node, int direction) noexcept {
  if (direction < kOwnedDirections) return {edge_family(kind, direction), node};
  return {edge_family(end_kind(kind, direction), opposite(direction)),
          node + end_offset(kind, direction)};
}

GeometrySizes::GeometrySizes(const StuffedBrick& brick) noexcept
    : zeros(brick.zero[kCorner].count() + brick.zero[kCentre].count()), cuts(0) {
  for (const BrickMask& cut : brick.cut) cuts += cut.count();
}

namespace {

/// `for_each(mask, visit)` calls `visit(x, y, z, rank)` for those bits of a mask that are
/// wanted, and returns how many there are in all.
template <class ForEach>
std::byte* pack(const StuffedLattice& lattice,
                const StuffedBrick& brick,
                const ForEach& for_each,
                std::byte* out) noexcept {
  const GeometrySizes sizes(brick);
  std::byte* const directions = out + (sizes.bytes() - sizes.zeros);
  const auto write = [&](std::size_t i, int family, int low) {
    const float fraction =
        lattice.cuts.fraction[static_cast<std::size_t>(family)][static_cast<std::size_t>(low)];
    std::memcpy(out + i * sizeof(fraction), &fraction, sizeof(fraction));
  };
  std::size_t first = 0;
  for (const NodeKind kind : {kCorner, kCentre}) {
    const WarpedLattice& warped = lattice.warped;
    first += for_each(brick.zero[kind], [&](int x, int y, int z, std::size_t rank) {
      const int node = halo_index(x, y, z);
      const bool moved = warped.warped[kind].test(node);
      const std::uint8_t direction =
          moved ? warped.direction[kind][static_cast<std::size_t>(node)] : kUnmoved;
      directions[first + rank] = static_cast<std::byte>(direction);
      if (!moved) return;
      const auto [family, low] = moved_along(kind, node, direction);
      write(first + rank, family, low);
    });
  }
  for (int family = 0; family < kEdgeFamilies; ++family) {
    first += for_each(brick.cut[static_cast<std::size_t>(family)],
                      [&](int x, int y, int z, std::size_t rank) {
                        write(first + rank, family, halo_index(x, y, z));
                      });
  }
  return out + sizes.bytes();
}

}  // namespace

TET_VECTOR_CLONES
std::byte* pack_geometry(const StuffedLattice& lattice,
                         const StuffedBrick& brick,
                         std::byte* out) noexcept {
  const auto for_each = [](const BrickMask& mask, const auto& visit) {
    std::size_t rank = 0;
    for_each_bit(mask, [&](int x, int y, int z) { visit(x, y, z, rank++); });
    return rank;
  };
  return pack(lattice, brick, for_each, out);
}

std::byte* pack_geometry_in_reach(const StuffedLattice& lattice,
                                  const StuffedBrick& brick,
                                  std::size_t o,
                                  std::byte* out) noexcept {
  const auto for_each = [o](const BrickMask& mask, const auto& visit) {
    return for_each_in_reach(mask, o, visit);
  };
  return pack(lattice, brick, for_each, out);
}

}  // namespace tet
