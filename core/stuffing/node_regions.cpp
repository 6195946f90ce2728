#include "core/stuffing/node_regions.h"

#include <cstddef>

namespace tet {
namespace {

constexpr std::size_t kPlanes = NodePlanes::kPlanes;

/// The next plane's nodes on short edges from these: each centre from the four corners around
/// it.
NodePlane centres_beside(const NodePlane& corners) noexcept {
  std::array<std::uint64_t, 4> rows{};
  for (std::size_t i = 0; i < 3; ++i) rows[i] = corners.word[i] | corners.word[i] >> 1;
  NodePlane out;
  for (std::size_t i = 0; i < 3; ++i) out.word[i] = rows[i] | rows[i] >> 16 | rows[i + 1] << 48;
  return out;
}

NodePlane corners_beside(const NodePlane& centres) noexcept {
  std::array<std::uint64_t, 4> rows{};
  for (std::size_t i = 0; i < 3; ++i) rows[i + 1] = centres.word[i] | centres.word[i] << 1;
  NodePlane out;
  for (std::size_t i = 0; i < 3; ++i) {
    out.word[i] = rows[i + 1] | rows[i + 1] << 16 | rows[i] >> 48;
  }
  return out;
}

/// A plane's own nodes on long edges from these.
NodePlane beside_in_plane(const NodePlane& nodes) noexcept {
  const auto& [a, b, c] = nodes.word;
  return {
      {a << 1 | a >> 1 | a << 16 | a >> 16 | b << 48,
       b << 1 | b >> 1 | b << 16 | b >> 16 | a >> 48 | c << 48,
       c << 1 | c >> 1 | c << 16 | c >> 16 | b >> 48}
  };
}

NodePlane beside(const NodePlane& plane, std::size_t number) noexcept {
  return number % 2 == kCorner ? centres_beside(plane) : corners_beside(plane);
}

void add(NodePlane& plane, const NodePlane& more) noexcept {
  for (std::size_t w = 0; w < 3; ++w) plane.word[w] |= more.word[w];
}

/// A plane within the box: rows and bits beyond it are none of its nodes.
constexpr NodePlane kWithin = [] {
  NodePlane plane;
  for (int y = NodePlanes::kMin; y <= NodePlanes::kMax; ++y) {
    for (int z = NodePlanes::kMin; z <= NodePlanes::kMax; ++z) {
      const int bit = (y + 2) * 16 + z + 2;
      plane.word[static_cast<std::size_t>(bit / 64)] |= std::uint64_t{1} << bit % 64;
    }
  }
  return plane;
}();

bool any(const NodePlane& plane) noexcept {
  return (plane.word[0] | plane.word[1] | plane.word[2]) != 0;
}

/// Where a plane of the box lies in a halo set.
std::size_t first_word(std::size_t plane) noexcept {
  return 4 * (plane / 2 + static_cast<std::size_t>(NodePlanes::kMin + 2));
}

/// A plane's nodes on edges from these: long ones from itself and the next of its kind, short
/// ones from the other kind.
NodePlane plane_beside(const NodePlanes& from, std::size_t to) noexcept {
  NodePlane found = beside_in_plane(from.plane[to]);
  if (to > 0) add(found, beside(from.plane[to - 1], to - 1));
  if (to > 1) add(found, from.plane[to - 2]);
  if (to + 1 < kPlanes) add(found, beside(from.plane[to + 1], to + 1));
  if (to + 2 < kPlanes) add(found, from.plane[to + 2]);
  return found;
}

/// Fills a set of nodes from its first one.
class Flood {
 public:
  Flood(const NodePlanes& nodes, const NodePlanes& zero) : nodes_(nodes), zero_(zero) {}

  const NodePlanes& fill() noexcept {
    seed();
    for (bool grown = true; grown && !(reached_ == nodes_);) {
      grown = false;
      for (std::size_t i = 0; i < kPlanes; ++i) grown |= flow(i);
      if (!grown || reached_ == nodes_) break;
      for (std::size_t i = kPlanes; i-- > 0;) grown |= flow(i);
    }
    return reached_;
  }

 private:
  void seed() noexcept {
    for (std::size_t i = 0; i < kPlanes; ++i) {
      for (std::size_t w = 0; w < 3; ++w) {
        const std::uint64_t word = nodes_.plane[i].word[w];
        if (word == 0) continue;
        reached_.plane[i].word[w] = word & (~word + 1);
        nonzero_.plane[i].word[w] = reached_.plane[i].word[w] & ~zero_.plane[i].word[w];
        return;
      }
    }
  }

  bool flow(std::size_t to) noexcept {
    NodePlane rest, rest_zero;  // that no edge has led to so far
    for (std::size_t w = 0; w < 3; ++w) {
      const std::uint64_t word = nodes_.plane[to].word[w] & ~reached_.plane[to].word[w];
      rest_zero.word[w] = word & zero_.plane[to].word[w];
      rest.word[w] = word ^ rest_zero.word[w];
    }
    std::uint64_t more = 0;
    if (any(rest)) {
      const NodePlane found = plane_beside(reached_, to);
      for (std::size_t w = 0; w < 3; ++w) {
        const std::uint64_t grown = found.word[w] & rest.word[w];
        reached_.plane[to].word[w] |= grown;
        nonzero_.plane[to].word[w] |= grown;
        more |= grown;
      }
    }
    if (any(rest_zero)) {
      const NodePlane found = plane_beside(nonzero_, to);
      for (std::size_t w = 0; w < 3; ++w) {
        const std::uint64_t grown = found.word[w] & rest_zero.word[w];
        reached_.plane[to].word[w] |= grown;
        more |= grown;
      }
    }
    return more != 0;
  }

  const NodePlanes& nodes_;
  const NodePlanes& zero_;
  NodePlanes reached_, nonzero_;
};

}  // namespace

NodePlanes::NodePlanes(const NodeSets& nodes) noexcept {
  for (std::size_t i = 0; i < kPlanes; ++i) {
    for (std::size_t w = 0; w < 3; ++w) {
      plane[i].word[w] = nodes[i % 2].word[first_word(i) + w];
    }
  }
}

NodePlanes NodePlanes::in_star(const NodeSets& nodes) noexcept {
  static const NodePlanes kStar(kBrickStar);
  return NodePlanes(nodes) & kStar;
}

NodeSets NodePlanes::sets() const noexcept {
  NodeSets nodes;
  for (std::size_t i = 0; i < kPlanes; ++i) {
    for (std::size_t w = 0; w < 3; ++w) {
      nodes[i % 2].word[first_word(i) + w] = plane[i].word[w];
    }
  }
  return nodes;
}

NodePlanes& NodePlanes::operator|=(const NodePlanes& o) noexcept {
  for (std::size_t i = 0; i < kPlanes; ++i) {
    for (std::size_t w = 0; w < 3; ++w) plane[i].word[w] |= o.plane[i].word[w];
  }
  return *this;
}

NodePlanes& NodePlanes::operator&=(const NodePlanes& o) noexcept {
  for (std::size_t i = 0; i < kPlanes; ++i) {
    for (std::size_t w = 0; w < 3; ++w) plane[i].word[w] &= o.plane[i].word[w];
  }
  return *this;
}

NodePlanes& NodePlanes::operator-=(const NodePlanes& o) noexcept {
  for (std::size_t i = 0; i < kPlanes; ++i) {
    for (std::size_t w = 0; w < 3; ++w) plane[i].word[w] &= ~o.plane[i].word[w];
  }
  return *this;
}

bool meet(const NodePlanes& a, const NodePlanes& b) noexcept {
  std::uint64_t common = 0;
  for (std::size_t i = 0; i < kPlanes; ++i) {
    for (std::size_t w = 0; w < 3; ++w) common |= a.plane[i].word[w] & b.plane[i].word[w];
  }
  return common != 0;
}

NodePlanes nodes_beside(const NodePlanes& nodes) noexcept {
  NodePlanes found;
  for (std::size_t i = 0; i < kPlanes; ++i) {
    const NodePlane plane = plane_beside(nodes, i);
    for (std::size_t w = 0; w < 3; ++w) {
      found.plane[i].word[w] = plane.word[w] & kWithin.word[w];
    }
  }
  return found;
}

NodePlanes first_region(const NodePlanes& nodes, const NodePlanes& zero) noexcept {
  return Flood(nodes, zero).fill();
}

}  // namespace tet
