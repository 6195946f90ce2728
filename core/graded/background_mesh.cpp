#include "core/graded/background_mesh.h"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "core/base/parallel.h"
#include "core/graded/field_points.h"
#include "core/lattice/background.h"

namespace tet {
namespace {

constexpr std::size_t kBricksPerRange = 4;

/// Calls `body(level, begin, end)` for ranges of each level's bricks, in any order; for some,
/// once cancelled.
template <class Body>
void for_each_brick_range(const GradedTree& graded,
                          const Cancellation& cancellation,
                          const Body& body) {
  for (std::size_t l = 0; l < graded.tree.levels.size(); ++l) {
    for_each_range(graded.tree.levels[l].bricks.size(), kBricksPerRange,
                   [&](std::size_t begin, std::size_t end) {
                     if (!cancellation.requested()) body(l, begin, end);
                   });
  }
}

/// Places, kinds and levels of a brick's nodes, in the order of their numbers.
void place_nodes(const GradedTree& graded,
                 std::size_t level,
                 std::size_t at,
                 BackgroundMesh& mesh) {
  const BrickCoord b = graded.tree.levels[level].bricks[at];
  std::uint64_t next = graded.nodes[level].first_vertex[at];
  const auto place = [&](const BrickMask& nodes, NodeKind kind) {
    for_each_bit(nodes, [&](int x, int y, int z) {
      const auto along = [&](std::int32_t brick, int cell) {
        return ((brick * kBrickEdge + cell) * 2 + kind) * (1 << level);
      };
      const LatticeCoord node{along(b.x, x), along(b.y, y), along(b.z, z)};
      mesh.node[next] = mesh.box ? mesh.box->clamped(node) : node;
      mesh.kind[next] = kind == kCorner           ? BackgroundNode::kCorner
                        : mesh.node[next] == node ? BackgroundNode::kCentre
                                                  : BackgroundNode::kCutMiddle;
      // Where leaves are refined at both sides of a face, its middle is a corner of theirs.
      const bool in_face = mesh.kind[next] == BackgroundNode::kCutMiddle;
      mesh.level[next++] = static_cast<std::uint8_t>(in_face && level > 0 ? level - 1 : level);
    });
  };
  place(graded.nodes[level].corner[at], kCorner);
  place(graded.nodes[level].centre[at], kCentre);
}

void sample_nodes(std::span<const LatticeCoord> nodes, LatticeSampler& sampler, float* phi) {
  FieldPoints points;
  std::array<double, FieldPoints::kSize> values;
  for (std::size_t first = 0; first < nodes.size(); first += FieldPoints::kSize) {
    const std::size_t count = std::min(FieldPoints::kSize, nodes.size() - first);
    NodeBounds bounds;
    for (std::size_t i = 0; i < count; ++i) {
      const LatticeCoord node = nodes[first + i];
      bounds.add(node);
      points.x[i] = 0.5 * node.x;
      points.y[i] = 0.5 * node.y;
      points.z[i] = 0.5 * node.z;
    }
    sampler.focus(bounds);
    sampler.sample(points, count, values.data());
    for (std::size_t i = 0; i < count; ++i) phi[first + i] = PhiField::clamped(values[i]);
  }
}

/// Writes one brick's tets, and keeps those with a node inside, in front; with a box, of those
/// the ones of a leaf in it.
class BrickTets {
 public:
  BrickTets(const GradedTree& graded, const BackgroundMesh& mesh)
      : graded_(graded), numbers_(graded.tree, graded.nodes), mesh_(mesh) {}

  std::span<const NodeId> kept(std::size_t level, std::size_t at) {
    const OctreeLevel& bricks = graded_.tree.levels[level];
    if (!bricks.leaf[at].any()) return {};
    const BackgroundCells cells =
        gather_background(bricks, bricks.bricks[at], MeshRegion::kInside);
    ids_.resize(4 * count_background(cells).total());
    BackgroundCounts counts;
    fill_background(cells, numbers_, static_cast<int>(level), bricks.bricks[at], ids_.data(),
                    counts);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < ids_.size(); i += 4) {
      const std::span<const NodeId, 4> tet(&ids_[i], 4);
      if (mesh_.box && !is_of_leaf(tet)) continue;
      if (!has_inside_node(tet)) continue;
      std::copy_n(ids_.begin() + static_cast<std::ptrdiff_t>(i), 4,
                  ids_.begin() + static_cast<std::ptrdiff_t>(kept));
      kept += 4;
    }
    return std::span(ids_).first(kept);
  }

 private:
  bool has_inside_node(std::span<const NodeId, 4> tet) const {
    return std::ranges::any_of(tet, [&](NodeId node) { return mesh_.phi[node] < 0; });
  }
  /// And not of images alone, which need not have all of their nodes.
  bool is_of_leaf(std::span<const NodeId, 4> tet) const {
    const auto exists = [&](NodeId node) { return node < mesh_.node.size(); };
    const auto is_centre = [&](NodeId node) {
      return mesh_.kind[node] == BackgroundNode::kCentre;
    };
    return std::ranges::all_of(tet, exists) && std::ranges::any_of(tet, is_centre);
  }

  const GradedTree& graded_;
  NodeNumbers numbers_;
  const BackgroundMesh& mesh_;
  std::vector<NodeId> ids_;
};

void fill_nodes(const GradedTree& graded,
                const PhiField& field,
                const Cancellation& cancellation,
                BackgroundMesh& mesh) {
  mesh.node.resize(graded.node_count);
  mesh.kind.resize(graded.node_count);
  mesh.level.resize(graded.node_count);
  mesh.phi.resize(graded.node_count);
  for_each_brick_range(
      graded, cancellation, [&](std::size_t level, std::size_t begin, std::size_t end) {
        LatticeSampler sampler(field, cancellation);
        const LevelNodes& nodes = graded.nodes[level];
        for (std::size_t i = begin; i < end && !cancellation.requested(); ++i) {
          const std::uint64_t first = nodes.first_vertex[i];
          const std::size_t count =
              std::size_t{nodes.corner[i].count()} + nodes.centre[i].count();
          place_nodes(graded, level, i, mesh);
          sample_nodes(std::span(mesh.node).subspan(first, count), sampler,
                       &mesh.phi[0] + first);
        }
      });
}

/// In two passes: count, then fill.
void fill_tets(const GradedTree& graded,
               const Cancellation& cancellation,
               BackgroundMesh& mesh) {
  std::vector<std::size_t> first_brick{0};
  for (const OctreeLevel& level : graded.tree.levels) {
    first_brick.push_back(first_brick.back() + level.bricks.size());
  }
  std::vector<std::uint64_t> count(first_brick.back());
  const auto for_each = [&](const auto& visit) {
    for_each_brick_range(graded, cancellation,
                         [&](std::size_t level, std::size_t begin, std::size_t end) {
                           BrickTets tets(graded, mesh);
                           for (std::size_t i = begin; i < end; ++i) {
                             visit(first_brick[level] + i, tets.kept(level, i));
                           }
                         });
  };
  for_each([&](std::size_t brick, std::span<const NodeId> ids) { count[brick] = ids.size(); });
  const auto first = offsets_from_counts(count.size(), [&](std::size_t i) { return count[i]; });
  mesh.tets.resize(first.back());
  for_each([&](std::size_t brick, std::span<const NodeId> ids) {
    std::copy(ids.begin(), ids.end(),
              mesh.tets.begin() + static_cast<std::ptrdiff_t>(first[brick]));
  });
}

}  // namespace

std::uint64_t background_bytes(std::uint64_t nodes, std::uint64_t tets) noexcept {
  constexpr std::uint64_t kPerNode =
      sizeof(LatticeCoord) + sizeof(BackgroundNode) + sizeof(std::uint8_t) + sizeof(float);
  return nodes * kPerNode + tets * 4 * sizeof(NodeId);
}

BackgroundMesh make_background(const GradedTree& graded,
                               const PhiField& field,
                               const Cancellation& cancellation) {
  BackgroundMesh mesh;
  if (graded.box) mesh.box.emplace(*graded.box);
  fill_nodes(graded, field, cancellation, mesh);
  if (!cancellation.requested()) fill_tets(graded, cancellation, mesh);
  return mesh;
}

}  // namespace tet
