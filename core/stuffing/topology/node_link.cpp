#include "core/stuffing/topology/node_link.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace tet {
namespace {

template <class Visit>
void for_each_direction(DirectionSet set, const Visit& visit) {
  for (unsigned bits = set; bits != 0; bits &= bits - 1) {
    visit(static_cast<std::size_t>(std::countr_zero(bits)));
  }
}

/// A ring as bits in its cyclic order, of 4 or 6.
using RingSet = unsigned;

/// Reads a ring out of a set of directions, seven of them at a time.
class RingReader {
 public:
  constexpr RingReader() {
    for (std::size_t d = 0; d < kDirections; ++d) {
      for (unsigned half = 0; half < 2; ++half) {
        for (unsigned bits = 0; bits < 128; ++bits) {
          ring_[d][half][bits] = read(kRing[d], bits << (7 * half));
        }
      }
    }
  }
  RingSet operator()(DirectionSet set, std::size_t direction) const noexcept {
    return ring_[direction][0][set & 127U] | ring_[direction][1][set >> 7];
  }

 private:
  static constexpr std::uint8_t read(const internal::Ring& ring, unsigned set) {
    unsigned bits = 0;
    for (std::size_t i = 0; i < ring.size; ++i) bits |= (set >> ring.direction[i] & 1) << i;
    return static_cast<std::uint8_t>(bits);
  }
  std::array<std::array<std::array<std::uint8_t, 128>, 2>, kDirections> ring_{};
};
constexpr RingReader kReadRing;

/// The edge to a zero node, seen along itself: around it lie tets of two ring nodes each. `+`
/// and
/// `+`, or `+` and `0`, are inside; the surface runs through `+` and `-`.
struct EdgeRing {
  RingSet plus, zero;
  std::size_t size;

  RingSet next(RingSet set) const noexcept {
    return (set >> 1 | set << (size - 1)) & ((1U << size) - 1);
  }
  RingSet before(RingSet set) const noexcept {
    return (set << 1 | set >> (size - 1)) & ((1U << size) - 1);
  }
  int triangles() const noexcept {
    const RingSet at_faces = zero & (before(plus) ^ next(plus));
    const RingSet within_tets = ~zero & ~next(zero) & (plus ^ next(plus));
    return std::popcount(at_faces) + std::popcount(within_tets & ((1U << size) - 1));
  }
  /// Ring nodes that are zero and lie between two `+`: their faces are inside.
  RingSet inner_faces() const noexcept { return zero & before(plus) & next(plus); }
};

EdgeRing ring_of(const NodeLink& link, std::size_t direction) noexcept {
  return {kReadRing(link.plus, direction), kReadRing(link.zero, direction),
          kRing[direction].size};
}

/// Vertices - edges + triangles of the part of the link that lies between `+` nodes.
int euler_characteristic(DirectionSet plus) noexcept {
  int vertices = 0, edge_ends = 0, triangle_corners = 0;
  for_each_direction(plus, [&](std::size_t d) {
    const EdgeRing ring = ring_of({plus, 0}, d);
    ++vertices;
    edge_ends += std::popcount(ring.plus);
    triangle_corners += std::popcount(ring.plus & ring.next(ring.plus));
  });
  return vertices - edge_ends / 2 + triangle_corners / 3;
}

/// Zero nodes of the link that lie within the inside, and the edges between zero nodes that do.
struct InnerZeros {
  int nodes = 0, edge_ends = 0;
  std::array<DirectionSet, kDirections> beyond{};  ///< `+` nodes joined across such edges

  void join(std::size_t a, std::size_t b) noexcept {
    beyond[a] = static_cast<DirectionSet>(beyond[a] | (1U << b));
    beyond[b] = static_cast<DirectionSet>(beyond[b] | (1U << a));
  }
};

InnerZeros inner_zeros(const NodeLink& link) noexcept {
  InnerZeros inner;
  for_each_direction(link.zero, [&](std::size_t z) {
    const EdgeRing ring = ring_of(link, z);
    if (ring.plus != 0 && ring.triangles() == 0) ++inner.nodes;
    for (RingSet faces = ring.inner_faces(); faces != 0; faces &= faces - 1) {
      const auto at = static_cast<std::size_t>(std::countr_zero(faces));
      ++inner.edge_ends;  // each edge is met from both of its ends
      inner.join(kRing[z].direction[(at + ring.size - 1) % ring.size],
                 kRing[z].direction[(at + 1) % ring.size]);
    }
  });
  return inner;
}

/// Connected parts of the inside, as the link sees it.
int components(DirectionSet plus, const InnerZeros& inner) noexcept {
  int count = 0;
  while (plus != 0) {
    ++count;
    DirectionSet front = static_cast<DirectionSet>(plus & -plus);
    while (front != 0) {
      plus = static_cast<DirectionSet>(plus & ~front);
      DirectionSet next = 0;
      for_each_direction(front, [&](std::size_t d) {
        next = static_cast<DirectionSet>(next | kLinkNeighbours[d] | inner.beyond[d]);
      });
      front = static_cast<DirectionSet>(next & plus);
    }
  }
  return count;
}

/// One bit for each set of directions.
class DirectionSets {
 public:
  template <class Holds>
  explicit constexpr DirectionSets(const Holds& holds) {
    for (unsigned set = 0; set < kSets; ++set) {
      if (holds(set)) word_[set / 64] |= std::uint64_t{1} << set % 64;
    }
  }
  constexpr bool has(DirectionSet set) const noexcept {
    return (word_[set / 64U] >> set % 64U & 1) != 0;
  }

 private:
  static constexpr unsigned kSets = 1U << kDirections;
  std::array<std::uint64_t, kSets / 64> word_{};
};

/// Sets whose ends are one connected part of the sphere around a node, or none.
constexpr DirectionSets kConnected([](unsigned set) {
  unsigned front = set & (~set + 1), reached = front;
  while (front != 0) {
    unsigned next = 0;
    for (; front != 0; front &= front - 1) {
      next |= kLinkNeighbours[static_cast<std::size_t>(std::countr_zero(front))];
    }
    front = next & set & ~reached;
    reached |= front;
  }
  return reached == set;
});

/// Sets with three ends that are neighbours: with the node, a tet.
constexpr DirectionSets kWithTriangle([](unsigned set) {
  for (unsigned rest = set; rest != 0; rest &= rest - 1) {
    const internal::Ring& ring = kRing[static_cast<std::size_t>(std::countr_zero(rest))];
    for (std::size_t i = 0; i < ring.size; ++i) {
      const unsigned pair =
          1U << ring.direction[i] | 1U << ring.direction[i + 1 == ring.size ? 0 : i + 1];
      if ((set & pair) == pair) return true;
    }
  }
  return false;
});

DirectionSet minus_of(const NodeLink& link) noexcept {
  return static_cast<DirectionSet>(kAllDirections & ~(unsigned{link.plus} | link.zero));
}

/// The ends of a node's edges that are in `nodes`, row by row: those with the same x and y are
/// two bits of one.
DirectionSet ends_in(const std::array<HaloSet, kNodeKinds>& nodes,
                     NodeKind kind,
                     int node) noexcept {
  const int row = node >> 4, z = node & 15;
  const auto bits = [](const HaloSet& set, int at, int shift) {
    std::uint16_t word = 0;
    std::memcpy(&word, reinterpret_cast<const char*>(set.word.data()) + 2 * at, sizeof(word));
    return static_cast<unsigned>(word) >> shift;
  };
  const HaloSet& same = nodes[kind];
  const unsigned around = bits(same, row, z - 1);
  unsigned ends = (bits(same, row + 16, z) & 1) | (bits(same, row + 1, z) & 1) << 1 |
                  (around & 4) | (bits(same, row - 16, z) & 1) << 7 |
                  (bits(same, row - 1, z) & 1) << 8 | (around & 1) << 9;
  // A centre's corners are at its own place and one further on, a corner's centres one before.
  const HaloSet& other = nodes[end_kind(kind, kOwnedDirections - 1)];
  const int low = kind == kCentre ? row : row - 17, low_z = kind == kCentre ? z : z - 1;
  const auto pair = [&](int at) { return bits(other, at, low_z) & 3; };
  const auto reversed = [](unsigned two) { return two >> 1 | (two & 1) << 1; };
  ends |= pair(low + 16) << 3 | pair(low + 17) << 5 | reversed(pair(low + 1)) << 10 |
          reversed(pair(low)) << 12;
  return static_cast<DirectionSet>(ends);
}

}  // namespace

NodeLink link_of(const std::array<HaloSet, kNodeKinds>& plus,
                 const std::array<HaloSet, kNodeKinds>& zero,
                 NodeKind kind,
                 int node) noexcept {
  return {ends_in(plus, kind, node), ends_in(zero, kind, node)};
}

bool has_tet_of_zeros(const NodeLink& link) noexcept { return kWithTriangle.has(link.zero); }

bool is_plainly_manifold(const NodeLink& link) noexcept {
  return kConnected.has(link.plus) && kConnected.has(minus_of(link)) && !has_tet_of_zeros(link);
}

SurfaceAtNode surface_at(const NodeLink& link) noexcept {
  SurfaceAtNode surface;
  for_each_direction(link.zero, [&](std::size_t d) {
    const int pairs = ring_of(link, d).triangles() / 2;
    if (pairs <= 1) return;
    surface.manifold = false;
    if (d >= kOwnedDirections) return;
    ++surface.non_manifold_edges;
    surface.extra_pairs += pairs - 1;
  });
  // The inside, on the sphere, is an open surface: its parts have 2 * parts - chi ends in all,
  // and each end is a cycle of boundary triangles.
  const InnerZeros inner = inner_zeros(link);
  const int chi = euler_characteristic(link.plus) + inner.nodes - inner.edge_ends / 2;
  const int cycles = 2 * components(link.plus, inner) - chi;
  surface.on_surface = cycles > 0;
  if (cycles > 1) surface.manifold = false;
  return surface;
}

}  // namespace tet
