#include "core/stuffing/topology/surface_regions.h"

#include <cstddef>

#include "core/stuffing/topology/node_link.h"

namespace tet {
namespace {

/// More regions than a surface that is resolved has near a brick.
constexpr std::size_t kMaxRegions = 16;

/// Nodes whose signs are known.
constexpr HaloSet kBox = halo_cube(NodePlanes::kMin, NodePlanes::kMax);

/// The nodes of the box with a `-` beside them in the box.
NodePlanes beside_minus(const SignedNodes& signs) noexcept {
  NodeSets minus;
  for (const NodeKind kind : {kCorner, kCentre}) {
    minus[kind] = kBox - signs.plus[kind] - signs.zero[kind];
  }
  return nodes_beside(NodePlanes(minus));
}

/// Returns those of some zeros without a `-` beside them that are in no tet of zeros: all tets
/// around them that can be seen have a `+`.
NodePlanes in_no_tet_of_zeros(const NodePlanes& zeros, const SignedNodes& signs) noexcept {
  if (!zeros.any()) return zeros;
  NodeSets inner = zeros.sets();
  for (const NodeKind kind : {kCorner, kCentre}) {
    HaloSet outer;
    for_each_bit(inner[kind], [&](int node) {
      if (has_tet_of_zeros(link_of(signs.plus, signs.zero, kind, node))) outer.set(node);
    });
    inner[kind] -= outer;
  }
  return NodePlanes(inner);
}

/// False where there are too many.
bool find_regions(NodePlanes nodes, const NodePlanes& zero, std::vector<NodeRegion>& regions) {
  while (nodes.any()) {
    if (regions.size() == kMaxRegions) return false;
    NodeRegion& region = regions.emplace_back();
    region.nodes = first_region(nodes, zero);
    region.beside = nodes_beside(region.nodes);
    nodes -= region.nodes;
  }
  return true;
}

/// Unites the regions of which `hang_together(a, b)`.
template <class HangTogether>
void unite(std::vector<NodeRegion>& regions, const HangTogether& hang_together) {
  for (std::size_t i = 0; i < regions.size(); ++i) {
    for (std::size_t k = i + 1; k < regions.size();) {
      if (!hang_together(regions[i], regions[k])) {
        ++k;
        continue;
      }
      regions[i].nodes |= regions[k].nodes;
      regions[i].beside |= regions[k].beside;
      regions.erase(regions.begin() + static_cast<std::ptrdiff_t>(k));
      k = i + 1;  // the region has grown
    }
  }
}

/// Whether a tet at an edge between two zeros is not all inside, as far as can be seen: beyond
/// the star too, as there a tet may end on a face of three. What is not inside then hangs
/// together along the edge.
bool has_outer_tet(const SignedNodes& signs, NodeKind kind, int node, int direction) {
  const internal::Ring& ring = kRing[static_cast<std::size_t>(direction)];
  bool seen_before = false, plus_before = false, minus_before = false;
  for (std::size_t i = 0; i <= ring.size; ++i) {  // the first again in the end
    const int d = ring.direction[i % ring.size];
    const NodeKind end = end_kind(kind, d);
    const int at = node + end_offset(kind, d);
    const bool seen = kBox.test(at), plus = signs.plus[end].test(at);
    const bool minus = !plus && !signs.zero[end].test(at);
    const bool all_inside = (plus || plus_before) && !minus && !minus_before;
    if (i > 0 && seen && seen_before && !all_inside) return true;
    seen_before = seen;
    plus_before = plus;
    minus_before = minus;
  }
  return false;
}

/// Whether what is not inside hangs together along an edge from a zero to one of some others.
bool is_joined(NodeKind kind, int node, const NodeSets& to, const SignedNodes& signs) {
  for (int d = 0; d < kDirections; ++d) {
    if (to[end_kind(kind, d)].test(node + end_offset(kind, d)) &&
        has_outer_tet(signs, kind, node, d)) {
      return true;
    }
  }
  return false;
}

/// Whether what is not inside hangs together along an edge between zeros of two regions.
bool are_joined(const NodeRegion& a,
                const NodeRegion& b,
                const NodePlanes& zero,
                const SignedNodes& signs) {
  if (!meet(a.beside, b.nodes)) return false;
  const NodeSets from = (a.nodes & zero & b.beside).sets(), to = (b.nodes & zero).sets();
  bool joined = false;
  for (const NodeKind kind : {kCorner, kCentre}) {
    for_each_bit(from[kind],
                 [&](int node) { joined = joined || is_joined(kind, node, to, signs); });
  }
  return joined;
}

/// Whether some of the nodes are other bricks' own.
bool has_others_nodes(const NodePlanes& nodes) noexcept {
  static const NodePlanes own({kOwnNodes, kOwnNodes});
  return (nodes - own).any();
}

}  // namespace

SurfaceRegions::SurfaceRegions(const SignedNodes& signs)
    : StarSigns(signs.plus, signs.zero),
      inner(in_no_tet_of_zeros(zero - beside_minus(signs), signs)) {
  zero -= inner;
  too_many =
      !find_regions(plus | inner, inner, inside) || !find_regions(minus | zero, zero, others);
  if (too_many) return;
  // A zero is an end of each region of `+` beside it.
  unite(inside, [&](const NodeRegion& a, const NodeRegion& b) {
    return meet(a.beside & b.beside, zero);
  });
  unite(others, [&](const NodeRegion& a, const NodeRegion& b) {
    return are_joined(a, b, zero, signs);
  });
}

SurfaceRegions::SurfaceRegions(const StarSigns& star, const NodePlanes& inner_zeros)
    : StarSigns(star), inner(inner_zeros) {
  zero -= inner;
  const auto add = [](const NodePlanes& nodes, std::vector<NodeRegion>& regions) {
    regions.push_back({nodes, nodes_beside(nodes)});
  };
  add(plus | inner, inside);
  add(minus | zero, others);
}

bool SurfaceRegions::have_one_sheet() const noexcept {
  // Around others' nodes not all can be seen here.
  return !too_many && inside.size() == 1 && others.size() == 1 && !has_others_nodes(inner);
}

std::optional<NodePlanes> find_inner_zeros(const StarSigns& star,
                                           const NodePlanes& lone,
                                           const SignedNodes& signs) {
  const NodePlanes inner = in_no_tet_of_zeros(lone - beside_minus(signs), signs);
  if ((inner - nodes_beside(star.plus)).any()) return std::nullopt;
  const NodeSets to = (star.zero - lone).sets(), from = (lone - inner).sets();
  bool all_joined = true;
  for (const NodeKind kind : {kCorner, kCentre}) {
    for_each_bit(from[kind], [&](int node) {
      all_joined = all_joined && is_joined(kind, node, to, signs);
    });
  }
  if (!all_joined) return std::nullopt;
  return inner;
}

}  // namespace tet
