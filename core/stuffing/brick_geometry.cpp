#include "core/stuffing/brick_geometry.h"

#include <bit>
#include <cstring>

namespace tet {
namespace {

/// The edge that a node moved along, by its family and its lower node.
struct MovedAlong {
  std::size_t family, low;
};

MovedAlong moved_along(NodeKind kind, std::size_t node, int direction) noexcept {
  if (direction < kOwnedDirections) {
    return {static_cast<std::size_t>(edge_family(kind, direction)), node};
  }
  const int low = static_cast<int>(node) + end_offset(kind, direction);
  return {static_cast<std::size_t>(edge_family(end_kind(kind, direction), opposite(direction))),
          static_cast<std::size_t>(low)};
}

std::size_t brick_index(int x, int y, int z) noexcept {
  return static_cast<std::size_t>(halo_index(x, y, z));
}

/// Bits of a neighbour's slice that lie among the nodes [0, 8]^3.
constexpr std::uint64_t reachable_bits(int by, int bz) noexcept {
  constexpr std::uint64_t kRowZero = 0xff, kFirstOfRows = 0x0101010101010101;
  return (by == 1 ? kRowZero : ~std::uint64_t{0}) &
         (bz == 1 ? kFirstOfRows : ~std::uint64_t{0});
}

/// Calls `visit(index, rank)` for each bit of a neighbour's mask that is within reach: its halo
/// index, and how many bits of the mask come before it. Returns the number of bits.
template <class Visit>
std::size_t for_each_in_reach(
    const BrickMask& mask, int bx, int by, int bz, const Visit& visit) noexcept {
  const std::uint64_t reachable = reachable_bits(by, bz);
  std::size_t before = 0;
  for (int x = 0; x < 8; ++x) {
    const std::uint64_t slice = mask.slice[static_cast<std::size_t>(x)];
    const std::uint64_t wanted = bx == 0 || x == 0 ? slice & reachable : 0;
    for (std::uint64_t bits = wanted; bits != 0; bits &= bits - 1) {
      const int bit = std::countr_zero(bits);
      const std::uint64_t lower = slice & ((std::uint64_t{1} << bit) - 1);
      visit(brick_index(x + 8 * bx, (bit >> 3) + 8 * by, (bit & 7) + 8 * bz),
            before + static_cast<std::size_t>(std::popcount(lower)));
    }
    before += static_cast<std::size_t>(std::popcount(slice));
  }
  return before;
}

float fraction_at(const std::byte* geometry, std::size_t i) noexcept {
  float fraction;
  std::memcpy(&fraction, geometry + i * sizeof(float), sizeof(float));
  return fraction;
}

}  // namespace

GeometrySizes::GeometrySizes(const StuffedBrick& brick) noexcept
    : zeros(brick.zero[kCorner].count() + brick.zero[kCentre].count()), cuts(0) {
  for (const BrickMask& cut : brick.cut) cuts += cut.count();
}

std::byte* pack_geometry(const StuffedLattice& lattice,
                         const StuffedBrick& brick,
                         std::byte* out) noexcept {
  std::byte* direction_out = out + (GeometrySizes(brick).bytes() - GeometrySizes(brick).zeros);
  const auto& fractions = lattice.cuts.fraction;
  const auto write = [&](float fraction) {
    std::memcpy(out, &fraction, sizeof(fraction));
    out += sizeof(fraction);
  };
  for (const NodeKind kind : {kCorner, kCentre}) {
    for_each_bit(brick.zero[kind], [&](int x, int y, int z) {
      const std::size_t node = brick_index(x, y, z);
      const bool moved = lattice.warped.warped[kind].test(static_cast<int>(node));
      const std::uint8_t direction = moved ? lattice.warped.direction[kind][node] : kUnmoved;
      const MovedAlong edge = moved ? moved_along(kind, node, direction) : MovedAlong{0, 0};
      write(moved ? fractions[edge.family][edge.low] : 0);
      *direction_out++ = static_cast<std::byte>(direction);
    });
  }
  for (std::size_t family = 0; family < kEdgeFamilies; ++family) {
    for_each_bit(brick.cut[family],
                 [&](int x, int y, int z) { write(fractions[family][brick_index(x, y, z)]); });
  }
  return direction_out;
}

void unpack_geometry(const StuffedBrick& brick,
                     const std::byte* geometry,
                     int bx,
                     int by,
                     int bz,
                     StuffedLattice& lattice) noexcept {
  const GeometrySizes sizes(brick);
  const std::byte* directions = geometry + (sizes.bytes() - sizes.zeros);
  auto& fractions = lattice.cuts.fraction;
  std::size_t first = 0;
  for (const NodeKind kind : {kCorner, kCentre}) {
    first += for_each_in_reach(
        brick.zero[kind], bx, by, bz, [&](std::size_t node, std::size_t rank) {
          const auto direction = static_cast<std::uint8_t>(directions[first + rank]);
          if (direction == kUnmoved) return;
          lattice.warped.warped[kind].set(static_cast<int>(node));
          lattice.warped.direction[kind][node] = direction;
          const MovedAlong edge = moved_along(kind, node, direction);
          fractions[edge.family][edge.low] = fraction_at(geometry, first + rank);
        });
  }
  for (std::size_t family = 0; family < kEdgeFamilies; ++family) {
    first += for_each_in_reach(brick.cut[family], bx, by, bz,
                               [&](std::size_t low, std::size_t rank) {
                                 fractions[family][low] = fraction_at(geometry, first + rank);
                                 lattice.warped.cut[family].set(static_cast<int>(low));
                               });
  }
}

}  // namespace tet
