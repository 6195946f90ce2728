#include "core/graded/stuffed_background.h"

#include <algorithm>
#include <utility>

#include "core/base/parallel.h"

namespace tet {
namespace {

constexpr std::size_t kTetsPerRange = 8192, kNodesPerRange = 8192;

/// Calls `visit(i)` for the background tets of one range; for some, once cancelled.
template <class Visit>
void for_each_of_range(std::size_t range,
                       std::size_t tets,
                       const Cancellation& cancellation,
                       const Visit& visit) {
  const std::size_t end = std::min(tets, (range + 1) * kTetsPerRange);
  if (cancellation.requested()) return;
  for (std::size_t i = range * kTetsPerRange; i < end; ++i) visit(i);
}

}  // namespace

/// A background tet's nodes in ascending order.
struct StuffedBackground::OrderedTet {
  std::array<NodeId, 4> node{};
  bool negative = false;  ///< so ordered

  explicit OrderedTet(const NodeId* nodes) noexcept {
    std::copy_n(nodes, 4, node.begin());
    for (const auto& [i, j] : {std::pair(0U, 1U), {2U, 3U}, {0U, 2U}, {1U, 3U}, {1U, 2U}}) {
      if (node[i] < node[j]) continue;
      std::swap(node[i], node[j]);
      negative = !negative;
    }
  }
};

StuffedBackground::StuffedBackground(const BackgroundMesh& mesh,
                                     const SurfaceEdges& edges,
                                     const GradedLimits& limits,
                                     const Cancellation& cancellation)
    : mesh_(mesh), edges_(edges), onto_(warp_nodes(mesh, edges, limits)) {
  find_used_nodes();
  number_vertices();
  count_tets(cancellation);
}

/// Marks the nodes that are not `-` of tets with a `+` node: a stencil has all of these.
void StuffedBackground::find_used_nodes() {
  used_.resize(mesh_.node.size());
  for (std::size_t i = 0; i < mesh_.tets.size(); i += 4) {
    const NodeId* node = &mesh_.tets[i];
    const auto is_plus = [this](NodeId n) { return sign(n) == NodeSign::kPlus; };
    if (std::none_of(node, node + 4, is_plus)) continue;
    for (std::size_t k = 0; k < 4; ++k) {
      if (sign(node[k]) != NodeSign::kMinus) used_[node[k]] = true;
    }
  }
}

bool StuffedBackground::is_cut(NodeId low, std::uint32_t edge) const noexcept {
  return sign(low) != NodeSign::kZero && sign(edges_.high[edge]) != NodeSign::kZero;
}

void StuffedBackground::number_vertices() {
  vertex_of_node_.assign(mesh_.node.size(), kNoVertex);
  vertex_of_edge_.assign(edges_.count(), kNoVertex);
  std::uint32_t next = 0;
  for (NodeId node = 0; node < mesh_.node.size(); ++node) {
    if (used_[node]) vertex_of_node_[node] = next++;
    for (std::uint32_t e = edges_.first[node]; e < edges_.first[node + 1]; ++e) {
      if (is_cut(node, e)) vertex_of_edge_[e] = next++;
    }
  }
  vertex_count_ = next;
}

void StuffedBackground::count_tets(const Cancellation& cancellation) {
  const std::size_t tets = mesh_.tet_count();
  std::vector<std::uint64_t> count((tets + kTetsPerRange - 1) / kTetsPerRange);
  for_each_index(count.size(), [&](std::size_t r) {
    for_each_of_range(r, tets, cancellation, [&](std::size_t i) {
      const NodeId* node = &mesh_.tets[4 * i];
      const std::size_t number =
          stencil_number(sign(node[0]), sign(node[1]), sign(node[2]), sign(node[3]));
      count[r] += kStencils[number][0].tet_count;
    });
  });
  first_tet_ = offsets_from_counts(count.size(), [&](std::size_t r) { return count[r]; });
}

NodeId StuffedBackground::low_node(std::uint32_t edge) const noexcept {
  const auto after = std::upper_bound(edges_.first.begin(), edges_.first.end(), edge);
  return static_cast<NodeId>(after - edges_.first.begin() - 1);
}

WorldPoint StuffedBackground::cut_point(NodeId low, std::uint32_t edge) const noexcept {
  const LatticeCoord from = mesh_.node[low], to = mesh_.node[edges_.high[edge]];
  const auto t = static_cast<double>(edges_.fraction[edge]);
  const auto along = [&](std::int32_t a, std::int32_t b) { return 0.5 * (a + t * (b - a)); };
  return {along(from.x, to.x), along(from.y, to.y), along(from.z, to.z)};
}

WorldPoint StuffedBackground::place_of(NodeId node) const noexcept {
  const std::uint32_t onto = onto_[node];
  if (onto != SurfaceEdges::kNone && onto != kInPlace) return cut_point(low_node(onto), onto);
  const LatticeCoord at = mesh_.node[node];
  return {0.5 * at.x, 0.5 * at.y, 0.5 * at.z};
}

/// Calls `visit(Vertex)` for a node and the cut points it owns.
template <class Visit>
void StuffedBackground::for_each_vertex_of(NodeId node, const Visit& visit) const {
  if (vertex_of_node_[node] != kNoVertex) {
    visit(
        Vertex{vertex_of_node_[node], place_of(node), mesh_.level[node], mesh_.faces_at(node)});
  }
  for (std::uint32_t e = edges_.first[node]; e < edges_.first[node + 1]; ++e) {
    if (vertex_of_edge_[e] == kNoVertex) continue;
    const NodeId high = edges_.high[e];
    const int faces = mesh_.faces_at(node) & mesh_.faces_at(high);
    visit(Vertex{vertex_of_edge_[e], cut_point(node, e),
                 std::min(mesh_.level[node], mesh_.level[high]), static_cast<CutFaces>(faces)});
  }
}

VoxelBox StuffedBackground::corner_box() const noexcept {
  VoxelBox box{{INT32_MAX, INT32_MAX, INT32_MAX}, {INT32_MIN, INT32_MIN, INT32_MIN}};
  const auto add = [](double at, std::int32_t& min, std::int32_t& max) {
    min = std::min(min, static_cast<std::int32_t>(std::floor(at)));
    max = std::max(max, static_cast<std::int32_t>(std::ceil(at)));
  };
  for (NodeId node = 0; node < mesh_.node.size(); ++node) {
    for_each_vertex_of(node, [&](const Vertex& vertex) {
      add(vertex.at.x, box.min.x, box.max.x);
      add(vertex.at.y, box.min.y, box.max.y);
      add(vertex.at.z, box.min.z, box.max.z);
    });
  }
  return box;
}

int StuffedBackground::levels() const noexcept {
  int levels = 0;
  for (NodeId node = 0; node < mesh_.node.size(); ++node) {
    if (used_[node]) levels = std::max<int>(levels, mesh_.level[node]);
  }
  return levels;
}

std::vector<std::uint8_t> StuffedBackground::vertex_levels() const {
  std::vector<std::uint8_t> levels(vertex_count_);
  for (NodeId node = 0; node < mesh_.node.size(); ++node) {
    for_each_vertex_of(node, [&](const Vertex& vertex) { levels[vertex.id] = vertex.level; });
  }
  return levels;
}

std::vector<CutFaces> StuffedBackground::vertex_faces() const {
  std::vector<CutFaces> faces(vertex_count_);
  for (NodeId node = 0; node < mesh_.node.size(); ++node) {
    for_each_vertex_of(node, [&](const Vertex& vertex) { faces[vertex.id] = vertex.faces; });
  }
  return faces;
}

SplitTet StuffedBackground::split_of(
    const OrderedTet& tet, std::array<std::uint32_t, kStencilVertices>& id) const noexcept {
  SplitTet split;
  for (std::size_t i = 0; i < 4; ++i) {
    const LatticeCoord at = mesh_.node[tet.node[i]];
    split.sign[i] = sign(tet.node[i]);
    split.place[i] = {0.5 * at.x, 0.5 * at.y, 0.5 * at.z};
    id[i] = vertex_of_node_[tet.node[i]];
  }
  for (std::size_t e = 0; e < kTetEdge.size(); ++e) {
    const auto [low, high] = kTetEdge[e];
    if (!split.is_cut(low, high)) continue;
    const std::uint32_t edge = edges_.find(tet.node[low], tet.node[high]);
    split.fraction[e] = edges_.fraction[edge];
    id[cut_on_edge(e)] = vertex_of_edge_[edge];
  }
  return split;
}

/// The tets that stand for one of the background; returns the end.
template <class Index>
Index* StuffedBackground::write_tets(std::size_t at, bool mirrors, Index* out) const noexcept {
  const OrderedTet tet(&mesh_.tets[4 * at]);
  std::array<std::uint32_t, kStencilVertices> id{};
  const SplitTet split = split_of(tet, id);
  const bool negative = tet.negative != mirrors;
  for (const auto& [a, b, c, d] : split.tets()) {
    *out++ = id[a];
    *out++ = id[b];
    *out++ = id[negative ? d : c];
    *out++ = id[negative ? c : d];
  }
  return out;
}

template <class Index>
void StuffedBackground::fill_tets(bool mirrors,
                                  const Cancellation& cancellation,
                                  TetMesh& mesh) const {
  const std::span<std::byte> column = mesh.tets.bytes();
  for_each_index(first_tet_.size() - 1, [&](std::size_t r) {
    std::vector<Index> ids(4 * (first_tet_[r + 1] - first_tet_[r]));
    Index* next = ids.data();
    for_each_of_range(r, mesh_.tet_count(), cancellation,
                      [&](std::size_t i) { next = write_tets(i, mirrors, next); });
    const auto bytes = std::as_bytes(std::span(ids));
    std::copy(bytes.begin(), bytes.end(),
              column.begin() + static_cast<std::ptrdiff_t>(4 * sizeof(Index) * first_tet_[r]));
  });
}

void StuffedBackground::fill(const LatticeToWorld& to_world,
                             const Cancellation& cancellation,
                             TetMesh& mesh) const {
  const VoxelCoord origin = to_world.origin;
  for_each_range(mesh_.node.size(), kNodesPerRange, [&](std::size_t begin, std::size_t end) {
    for (std::size_t node = begin; node < end && !cancellation.requested(); ++node) {
      for_each_vertex_of(static_cast<NodeId>(node), [&](const Vertex& vertex) {
        const double x = vertex.at.x - origin.x, y = vertex.at.y - origin.y,
                     z = vertex.at.z - origin.z;
        const auto along = [&](std::size_t row) {
          const auto& [a, b, c] = to_world.linear[row];
          return a * x + b * y + c * z;
        };
        mesh.store_position(vertex.id, {along(0), along(1), along(2)});
      });
    }
  });
  if (mesh.header.index_type == IndexType::kUint64) {
    fill_tets<std::uint64_t>(to_world.mirrors, cancellation, mesh);
  } else {
    fill_tets<std::uint32_t>(to_world.mirrors, cancellation, mesh);
  }
}

}  // namespace tet
