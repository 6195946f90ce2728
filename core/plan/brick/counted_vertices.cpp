// Which vertices the bricks of a counted mesh own.
#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/base/brick_neighbours.h"
#include "core/base/parallel.h"
#include "core/lattice/reach.h"
#include "core/plan/brick/counted_mesh.h"

namespace tet {
namespace {

constexpr std::size_t kVerticesPerRange = 16;
/// Bricks whose vertices are held as whole masks.
constexpr std::size_t kFoundAtATime = 8192;

}  // namespace

void CountedMesh::find_vertices(const CountedMesh* earlier,
                                std::span<const BrickPlaces> unchanged,
                                const Cancellation& cancellation) {
  const auto known = [&](std::size_t level) -> KnownNodes {
    if (earlier == nullptr || level >= earlier->nodes_.size()) return {};
    return {&earlier->nodes_[level], unchanged[level]};
  };
  nodes_.resize(tree_.levels.size());
  find_finest_vertices(known(0), cancellation);
  for (std::size_t l = 1; l < tree_.levels.size(); ++l) {
    nodes_[l] = background_nodes(tree_.levels[l], tree_.levels[l - 1], nodes_[l - 1], known(l));
  }
}

void CountedMesh::find_finest_vertices(const KnownNodes& known,
                                       const Cancellation& cancellation) {
  const OctreeLevel& finest = tree_.levels[0];
  LevelNodes& nodes = nodes_[0];
  nodes.corner.reserve(finest.bricks.size());
  nodes.centre.reserve(finest.bricks.size());
  std::vector<BrickMask> corner, centre;
  for (std::size_t first = 0; first < finest.bricks.size(); first += kFoundAtATime) {
    const std::size_t last = std::min(first + kFoundAtATime, finest.bricks.size());
    const std::vector<std::size_t> wanted = unknown_bricks(known, first, last);
    corner.assign(wanted.size(), {});
    centre.assign(wanted.size(), {});
    for_each_range(wanted.size(), kVerticesPerRange, [&](std::size_t begin, std::size_t end) {
      if (cancellation.requested()) return;
      BrickNeighbours neighbours(finest.bricks,
                                 rules_.both_sides ? RowsAround::kAll : RowsAround::kLower);
      for (std::size_t i = begin; i < end; ++i) {
        const PlacesAround& around = neighbours.around(finest.bricks[wanted[i]]);
        const NodeMasks found = rules_.both_sides
                                    ? find_vertices_of_both_sides(wanted[i], around)
                                    : find_vertices_inside(wanted[i], around);
        corner[i] = found[kCorner];
        centre[i] = found[kCentre];
      }
    });
    if (known.nodes != nullptr) {
      const auto places = known.places.subspan(first, last - first);
      nodes.corner.append(known.nodes->corner, places, corner);
      nodes.centre.append(known.nodes->centre, places, centre);
      continue;
    }
    for (const BrickMask& mask : corner) nodes.corner.push_back(mask);
    for (const BrickMask& mask : centre) nodes.centre.push_back(mask);
  }
}

NodeMasks CountedMesh::find_vertices_inside(std::size_t brick,
                                            const PlacesAround& around) const {
  const StuffedBrick* stuffed = stuffed_at(static_cast<std::uint32_t>(brick));
  if (stuffed == nullptr) return {};
  return finest_vertices(*stuffed, lower_leaves(tree_.levels[0].leaf, around));
}

NodeMasks CountedMesh::find_vertices_of_both_sides(std::size_t brick,
                                                   const PlacesAround& around) {
  const MaskColumn& leaf = tree_.levels[0].leaf;
  if (!touches_surface(brick)) return {leaf_corners(lower_leaves(leaf, around)), leaf[brick]};
  const UsedByTets used = used_by_tets(surroundings(around), gather_halo(leaf, around));
  trim_cut_points(stuffed_[brick], used);
  return used.node;
}

void CountedMesh::trim_cut_points(std::uint32_t stuffed, const UsedByTets& used) {
  // Other bricks read this one's signs at the same time, but not its cut points.
  auto& cut = survey_.stuffed[stuffed].cut;
  for (std::size_t f = 0; f < kEdgeFamilies; ++f) {
    const BrickMask trimmed = cut[f] & used.edge[f];
    // What was packed has the cut points that were there before.
    if (!(trimmed == cut[f]) && !geometry_is_trimmed_)
      survey_.geometry.of_brick[stuffed] = nullptr;
    cut[f] = trimmed;
  }
}

}  // namespace tet
