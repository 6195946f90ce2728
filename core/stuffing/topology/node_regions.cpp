#include "core/stuffing/topology/node_regions.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "core/base/vector_clones.h"
#include "core/stuffing/topology/node_rows.h"

namespace tet {
namespace {

using internal::add_beside, internal::any, internal::read, internal::Rows, internal::write;

constexpr std::size_t kPlanes = NodePlanes::kPlanes;

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
  [[gnu::always_inline]] Flood(const NodePlanes& nodes,
                               const NodePlanes& zero,
                               NodePlanes& reached)
      : nodes_(nodes), zero_(zero), reached_(reached), nonzero_(reached) {
    nonzero_ -= zero;
  }

  [[gnu::always_inline]] void fill() noexcept {
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
  [[gnu::always_inline]] void start_sweep() noexcept { grown_ = left_ = Rows{}; }
  [[gnu::always_inline]] bool ended() const noexcept { return !any(grown_) || !any(left_); }

  [[gnu::always_inline]] void flow(std::size_t to) noexcept {
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

TET_VECTOR_CLONES
void split_star(const NodeSets& all_plus,
                const NodeSets& all_zero,
                const NodePlanes& within,
                StarSigns& star) noexcept {
  for (std::size_t i = 0; i < kPlanes; ++i) {
    const std::uint64_t* const plus = &all_plus[i % 2].word[first_word(i)];
    const std::uint64_t* const zero = &all_zero[i % 2].word[first_word(i)];
    Rows rows, plus_rows, zero_rows;
    read(within.plane[i], rows);
    std::memcpy(&plus_rows, plus, sizeof(plus_rows));
    std::memcpy(&zero_rows, zero, sizeof(zero_rows));
    write(rows & plus_rows, star.plus.plane[i]);
    write(rows & zero_rows, star.zero.plane[i]);
    write(rows & ~(plus_rows | zero_rows), star.minus.plane[i]);
  }
}

TET_VECTOR_CLONES
void find_lone(const StarSigns& star, NodePlanes& lone) noexcept {
  for (std::size_t i = 0; i < kPlanes; ++i) {
    Rows zero;
    read(star.zero.plane[i], zero);
    if (any(zero)) {
      Rows beside{};
      add_beside(star.minus, i, beside);
      zero &= ~beside;
    }
    write(zero, lone.plane[i]);
  }
}

const NodePlanes& star_planes() noexcept {
  static const NodePlanes star(kBrickStar);
  return star;
}

}  // namespace

StarSigns::StarSigns(const NodeSets& all_plus, const NodeSets& all_zero) noexcept {
  split_star(all_plus, all_zero, star_planes(), *this);
}

NodePlanes lone_zeros(const StarSigns& star) noexcept {
  NodePlanes lone;
  find_lone(star, lone);
  return lone;
}

TET_VECTOR_CLONES
bool NodePlanes::any() const noexcept {
  std::array<std::uint64_t, NodePlane::kWords> words{};
  for (const NodePlane& of : plane) {
    for (std::size_t w = 0; w < words.size(); ++w) words[w] |= of.word[w];
  }
  return (words[0] | words[1] | words[2] | words[3]) != 0;
}

NodePlanes::NodePlanes(const NodeSets& nodes) noexcept {
  for (std::size_t i = 0; i < kPlanes; ++i) {
    const std::uint64_t* const first = &nodes[i % 2].word[first_word(i)];
    std::copy_n(first, plane[i].word.size(), plane[i].word.begin());
  }
}

TET_VECTOR_CLONES
NodePlanes NodePlanes::in_star(const NodeSets& nodes) noexcept {
  return NodePlanes(nodes) & star_planes();
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
  return (common.word[0] | common.word[1] | common.word[2] | common.word[3]) != 0;
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
