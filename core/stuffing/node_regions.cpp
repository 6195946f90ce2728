#include "core/stuffing/node_regions.h"

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "core/base/vector_clones.h"

// Rows are passed by reference and always inlined: what a vector is passed in depends on the
// processor.
#define TET_INLINE [[gnu::always_inline]] inline

namespace tet {
namespace {

constexpr std::size_t kPlanes = NodePlanes::kPlanes;

/// All rows of a plane: what is done to one is done to each.
using Rows = std::uint16_t __attribute__((vector_size(sizeof(NodePlane))));

TET_INLINE void read(const NodePlane& plane, Rows& rows) noexcept {
  std::memcpy(&rows, plane.word.data(), sizeof(rows));
}
TET_INLINE void write(const Rows& rows, NodePlane& plane) noexcept {
  std::memcpy(plane.word.data(), &rows, sizeof(rows));
}
TET_INLINE bool any(const Rows& rows) noexcept {
  NodePlane plane;
  write(rows, plane);
  return (plane.word[0] | plane.word[1] | plane.word[2] | plane.word[3]) != 0;
}

/// Adds each row to the one before it.
TET_INLINE void add_to_previous(const Rows& rows, Rows& found) noexcept {
  constexpr Rows kNone{};
  found |= __builtin_shufflevector(rows, kNone, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14,
                                   15, 16);
}
TET_INLINE void add_to_next(const Rows& rows, Rows& found) noexcept {
  constexpr Rows kNone{};
  found |= __builtin_shufflevector(rows, kNone, 16, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12,
                                   13, 14);
}

/// Adds a plane's own nodes on long edges from these.
TET_INLINE void add_beside_in_plane(const Rows& nodes, Rows& found) noexcept {
  found |= nodes << 1 | nodes >> 1;
  add_to_previous(nodes, found);
  add_to_next(nodes, found);
}

/// Adds the centres on short edges from the corners of the next plane: each has four around it.
TET_INLINE void add_centres_beside(const Rows& corners, Rows& found) noexcept {
  const Rows rows = corners | corners >> 1;
  found |= rows;
  add_to_previous(rows, found);
}
TET_INLINE void add_corners_beside(const Rows& centres, Rows& found) noexcept {
  const Rows rows = centres | centres << 1;
  found |= rows;
  add_to_next(rows, found);
}

/// Adds a plane's nodes on edges from these: long ones from itself and the next of its kind,
/// short ones from the other kind.
TET_INLINE void add_beside(const NodePlanes& from, std::size_t to, Rows& found) noexcept {
  Rows rows, other{};
  read(from.plane[to], rows);
  add_beside_in_plane(rows, found);
  const auto add_kind = [&](std::size_t plane, Rows & sum) __attribute__((always_inline)) {
    if (plane >= kPlanes) return;
    read(from.plane[plane], rows);
    sum |= rows;
  };
  add_kind(to - 2, found);  // wraps below the first
  add_kind(to + 2, found);
  add_kind(to - 1, other);
  add_kind(to + 1, other);
  if (to % 2 == kCorner) {
    add_corners_beside(other, found);
  } else {
    add_centres_beside(other, found);
  }
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

/// Where a plane of the box lies in a halo set.
std::size_t first_word(std::size_t plane) noexcept {
  return NodePlane::kWords * (plane / 2 + static_cast<std::size_t>(NodePlanes::kMin + 2));
}

/// Fills a set of nodes from some of them.
class Flood {
 public:
  /// `reached` has the first ones.
  TET_INLINE Flood(const NodePlanes& nodes, const NodePlanes& zero, NodePlanes& reached)
      : nodes_(nodes), zero_(zero), reached_(reached), nonzero_(reached) {
    nonzero_ -= zero;
  }

  TET_INLINE void fill() noexcept {
    while (true) {
      start_sweep();
      for (std::size_t i = 0; i < kPlanes; ++i) flow(i);
      if (ended()) return;
      start_sweep();
      for (std::size_t i = kPlanes; i-- > 0;) flow(i);
      if (ended()) return;
    }
  }

 private:
  TET_INLINE void start_sweep() noexcept { grown_ = left_ = Rows{}; }
  TET_INLINE bool ended() const noexcept { return !any(grown_) || !any(left_); }

  TET_INLINE void flow(std::size_t to) noexcept {
    Rows nodes, reached;
    read(nodes_.plane[to], nodes);
    read(reached_.plane[to], reached);
    const Rows rest = nodes & ~reached;  // that no edge has led to so far
    if (!any(rest)) return;
    Rows zero, found{};
    read(zero_.plane[to], zero);
    add_beside(reached_, to, found);
    if (any(rest & zero)) {
      Rows found_from_nonzero{};
      add_beside(nonzero_, to, found_from_nonzero);
      found = (found & ~zero) | found_from_nonzero;
    }
    const Rows grown = rest & found;
    write(reached | grown, reached_.plane[to]);
    write((reached | grown) & ~zero, nonzero_.plane[to]);
    grown_ |= grown;
    left_ |= rest & ~grown;
  }

  const NodePlanes& nodes_;
  const NodePlanes& zero_;
  NodePlanes& reached_;
  NodePlanes nonzero_;
  Rows grown_{}, left_{};  // in this sweep; of the latter there may be less by now
};

TET_VECTOR_CLONES
void fill(const NodePlanes& nodes, const NodePlanes& zero, NodePlanes& reached) noexcept {
  Flood(nodes, zero, reached).fill();
}

TET_VECTOR_CLONES
void find_beside(const NodePlanes& nodes, NodePlanes& found) noexcept {
  Rows within;
  read(kWithin, within);
  for (std::size_t i = 0; i < kPlanes; ++i) {
    Rows beside{};
    add_beside(nodes, i, beside);
    write(beside & within, found.plane[i]);
  }
}

}  // namespace

NodePlanes::NodePlanes(const NodeSets& nodes) noexcept {
  for (std::size_t i = 0; i < kPlanes; ++i) {
    const std::uint64_t* const first = &nodes[i % 2].word[first_word(i)];
    std::copy_n(first, plane[i].word.size(), plane[i].word.begin());
  }
}

TET_VECTOR_CLONES
NodePlanes NodePlanes::in_star(const NodeSets& nodes) noexcept {
  static const NodePlanes star(kBrickStar);
  return NodePlanes(nodes) & star;
}

NodeSets NodePlanes::sets() const noexcept {
  NodeSets nodes;
  for (std::size_t i = 0; i < kPlanes; ++i) {
    std::ranges::copy(plane[i].word, &nodes[i % 2].word[first_word(i)]);
  }
  return nodes;
}

TET_VECTOR_CLONES
NodePlanes& NodePlanes::operator|=(const NodePlanes& o) noexcept {
  for (std::size_t i = 0; i < kPlanes; ++i) {
    for (std::size_t w = 0; w < NodePlane::kWords; ++w) plane[i].word[w] |= o.plane[i].word[w];
  }
  return *this;
}

TET_VECTOR_CLONES
NodePlanes& NodePlanes::operator&=(const NodePlanes& o) noexcept {
  for (std::size_t i = 0; i < kPlanes; ++i) {
    for (std::size_t w = 0; w < NodePlane::kWords; ++w) plane[i].word[w] &= o.plane[i].word[w];
  }
  return *this;
}

TET_VECTOR_CLONES
NodePlanes& NodePlanes::operator-=(const NodePlanes& o) noexcept {
  for (std::size_t i = 0; i < kPlanes; ++i) {
    for (std::size_t w = 0; w < NodePlane::kWords; ++w) plane[i].word[w] &= ~o.plane[i].word[w];
  }
  return *this;
}

TET_VECTOR_CLONES
bool meet(const NodePlanes& a, const NodePlanes& b) noexcept {
  NodePlane common;
  for (std::size_t i = 0; i < kPlanes; ++i) {
    for (std::size_t w = 0; w < NodePlane::kWords; ++w)
      common.word[w] |= a.plane[i].word[w] & b.plane[i].word[w];
  }
  return !(common == NodePlane());
}

NodePlanes nodes_beside(const NodePlanes& nodes) noexcept {
  NodePlanes found;
  find_beside(nodes, found);
  return found;
}

NodePlanes first_region(const NodePlanes& nodes, const NodePlanes& zero) noexcept {
  NodePlanes region;
  for (std::size_t i = 0; i < kPlanes; ++i) {
    for (std::size_t w = 0; w < NodePlane::kWords; ++w) {
      const std::uint64_t word = nodes.plane[i].word[w];
      if (word == 0) continue;
      region.plane[i].word[w] = word & (~word + 1);
      fill(nodes, zero, region);
      return region;
    }
  }
  return region;
}

}  // namespace tet
#undef TET_INLINE
