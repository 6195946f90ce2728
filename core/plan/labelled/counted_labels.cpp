#include "core/plan/labelled/counted_labels.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/base/parallel.h"
#include "core/labels/fill_labels.h"

namespace tet {
namespace {

constexpr std::size_t kLabelBricksPerRange = 16;

/// Which of the 27 around a brick is brick `o` of the eight beyond its upper faces.
constexpr std::size_t brick_beyond(std::size_t o) noexcept {
  return kItself + 9 * (o >> 2) + 3 * (o >> 1 & 1) + (o & 1);
}

/// Calls `visit(i, around)` for all bricks of a level. Parallel.
template <class Visit>
void for_each_brick_of(const OctreeLevel& level,
                       const Cancellation& cancellation,
                       const Visit& visit) {
  for_each_range(level.bricks.size(), kLabelBricksPerRange,
                 [&](std::size_t begin, std::size_t end) {
                   BrickNeighbours neighbours(level.bricks);
                   for (std::size_t i = begin; i < end && !cancellation.requested(); ++i) {
                     visit(i, neighbours.around(level.bricks[i]));
                   }
                 });
}

}  // namespace

CountedLabels::CountedLabels(LabelSurvey survey, Octree tree, const Cancellation& cancellation)
    : survey_(std::move(survey)), tree_(std::move(tree)) {
  find_leaves(cancellation);
  if (cancellation.requested()) return;
  for (OctreeLevel& level : tree_.levels) insert_corner_bricks(level);
  // Leaves of bricks that own corners alone: none.
  for (std::size_t l = 1; l < tree_.levels.size(); ++l) {
    std::vector<std::uint32_t> first;
    const LevelLeaves& leaves = leaves_[l];
    std::size_t run = 0;
    for (std::size_t i = 0; i < tree_.levels[l].bricks.size(); ++i) {
      first.push_back(static_cast<std::uint32_t>(run));
      BrickMask rest = tree_.levels[l].leaf[i];
      while (rest.any()) rest &= ~leaves.run[run++].cells;
    }
    first.push_back(static_cast<std::uint32_t>(run));
    leaves_[l].first = std::move(first);
  }
  find_vertices(cancellation);
  if (!cancellation.requested()) count_bricks(cancellation);
}

/// Finds the label of every leaf above the finest level, and drops those that are left out.
void CountedLabels::find_leaves(const Cancellation& cancellation) {
  leaves_.resize(tree_.levels.size());
  for (std::size_t l = 1; l < tree_.levels.size(); ++l) {
    OctreeLevel& level = tree_.levels[l];
    std::vector<std::vector<LabelLeaves>> found(level.bricks.size());
    std::vector<BrickMask> leaf(level.bricks.size());
    for_each_brick_of(level, cancellation, [&](std::size_t i, const PlacesAround&) {
      const BrickCoord b = level.bricks[i];
      for_each_bit(level.leaf[i], [&](int x, int y, int z) {
        const auto corner = [&](std::int32_t brick, int cell) {
          return (std::int64_t{brick} * kBrickEdge + cell) << l;
        };
        // All nodes of a leaf have one label: so has its lowest corner.
        const Label label =
            survey_.corner_label(corner(b.x, x), corner(b.y, y), corner(b.z, z));
        if (!survey_.rules.kept.holds(label)) return;
        leaf[i].set(x, y, z);
        auto run = std::ranges::find(found[i], label, &LabelLeaves::label);
        if (run == found[i].end()) run = found[i].insert(run, {label, {}});
        run->cells.set(x, y, z);
      });
      std::ranges::sort(found[i], {}, &LabelLeaves::label);
    });
    level.leaf = MaskColumn(leaf);
    for (const std::vector<LabelLeaves>& runs : found) {
      leaves_[l].run.insert(leaves_[l].run.end(), runs.begin(), runs.end());
    }
  }
}

LabelledPart CountedLabels::part_of(std::size_t brick) const noexcept {
  LabelledPart part;
  const BrickState state = survey_.state.of(tree_.levels[0].bricks[brick]);
  if (state.one()) {
    part.one = state.label();
  } else {
    part.brick = survey_.brick[state.place()].get();
  }
  if (nodes_[0].corner.empty()) return part;
  part.node = {&nodes_[0].corner[brick], &nodes_[0].centre[brick]};
  // While vertices are counted there are no ids yet.
  if (!nodes_[0].first_vertex.empty()) part.first = nodes_[0].first_vertex[brick];
  return part;
}

NodeMasks CountedLabels::vertices_of_finest(std::size_t brick,
                                            const PlacesAround& around) const {
  const MaskColumn& leaf = tree_.levels[0].leaf;
  NodeMasks nodes{leaf_corners(lower_leaves(leaf, around)), leaf[brick]};
  const BrickState state = survey_.state.of(tree_.levels[0].bricks[brick]);
  if (state.one()) return survey_.rules.kept.holds(state.label()) ? nodes : NodeMasks{};
  const LabelledBrick& found = *survey_.brick[state.place()];
  for (const NodeKind kind : {kCorner, kCentre}) {
    nodes[kind] &= ~found.unused[kind];
    if (survey_.rules.kept.all()) continue;
    for_each_bit(nodes[kind], [&](int x, int y, int z) {
      if (found.label[kind][static_cast<std::size_t>((x * 8 + y) * 8 + z)] !=
          survey_.rules.kept.left_out) {
        return;
      }
      nodes[kind].slice[static_cast<std::size_t>(x)] &= ~(std::uint64_t{1} << (y * 8 + z));
    });
  }
  return nodes;
}

void CountedLabels::find_vertices(const Cancellation& cancellation) {
  const OctreeLevel& finest = tree_.levels[0];
  nodes_.resize(tree_.levels.size());
  std::vector<NodeMasks> found(finest.bricks.size());
  for_each_brick_of(finest, cancellation, [&](std::size_t i, const PlacesAround& around) {
    found[i] = vertices_of_finest(i, around);
  });
  nodes_[0].corner.reserve(found.size());
  nodes_[0].centre.reserve(found.size());
  for (const NodeMasks& nodes : found) {
    nodes_[0].corner.push_back(nodes[kCorner]);
    nodes_[0].centre.push_back(nodes[kCentre]);
  }
  for (std::size_t l = 1; l < tree_.levels.size(); ++l) {
    nodes_[l] = background_nodes(tree_.levels[l], tree_.levels[l - 1], nodes_[l - 1]);
  }
}

void CountedLabels::count_bricks(const Cancellation& cancellation) {
  std::size_t bricks = 0;
  for (const OctreeLevel& level : tree_.levels) {
    first_brick_.push_back(bricks);
    bricks += level.bricks.size();
  }
  std::vector<std::uint64_t> vertices(bricks), tets(bricks);
  for (std::size_t l = 0; l < tree_.levels.size(); ++l) {
    for_each_brick_of(
        tree_.levels[l], cancellation, [&](std::size_t i, const PlacesAround& around) {
          const std::size_t brick = first_brick_[l] + i;
          vertices[brick] =
              l == 0 ? part_of(i).count()
                     : std::uint64_t{nodes_[l].corner[i].count()} + nodes_[l].centre[i].count();
          tets[brick] = tets_of({static_cast<int>(l), i}, around);
        });
  }
  first_vertex_ = offsets_from_counts(bricks, [&](std::size_t i) { return vertices[i]; });
  first_tet_ = offsets_from_counts(bricks, [&](std::size_t i) { return tets[i]; });
  for (std::size_t l = 0; l < tree_.levels.size(); ++l) {
    const auto begin = first_vertex_.begin() + static_cast<std::ptrdiff_t>(first_brick_[l]);
    nodes_[l].first_vertex.assign(
        begin, begin + static_cast<std::ptrdiff_t>(tree_.levels[l].bricks.size()));
  }
}

std::uint64_t CountedLabels::tets_of(BrickPlace place, const PlacesAround& around) const {
  const OctreeLevel& level = tree_.levels[static_cast<std::size_t>(place.level)];
  if (!level.leaf[place.brick].any()) return 0;
  if (place.level > 0) {
    return count_background(gather_background(level, around, MeshRegion::kInside)).total();
  }
  const LabelledParts all = parts(around);
  return count_alike(all, LeafFaces(leaves_around(tree_.levels[0].leaf, around)),
                     survey_.rules.kept) +
         (all[0].brick != nullptr ? all[0].brick->divided_tets : 0);
}

BrickPlace CountedLabels::place(std::size_t brick) const noexcept {
  const auto level = std::upper_bound(first_brick_.begin(), first_brick_.end(), brick) - 1;
  return {static_cast<int>(level - first_brick_.begin()), brick - *level};
}

LabelledParts CountedLabels::parts(const PlacesAround& around) const noexcept {
  LabelledParts parts;
  for (std::size_t o = 0; o < parts.size(); ++o) {
    const std::uint32_t at = around[brick_beyond(o)];
    if (at != kNoBrick) parts[o] = part_of(at);
  }
  return parts;
}

std::span<const LabelLeaves> CountedLabels::leaves_of(BrickPlace place) const noexcept {
  const LevelLeaves& leaves = leaves_[static_cast<std::size_t>(place.level)];
  const std::uint32_t begin = leaves.first[place.brick];
  return std::span(leaves.run).subspan(begin, leaves.first[place.brick + 1] - begin);
}

std::vector<std::uint8_t> CountedLabels::vertices_between_labels() const {
  std::vector<std::uint8_t> between(first_vertex_.back());
  for (std::size_t brick = 0; brick < tree_.levels[0].bricks.size(); ++brick) {
    const LabelledPart part = part_of(brick);
    if (part.brick == nullptr) continue;
    std::uint64_t vertex = part.first;
    for (const NodeKind kind : {kCorner, kCentre}) {
      const BrickMask& jokers = part.brick->joker[kind];
      for_each_bit(*part.node[kind], [&](int x, int y, int z) {
        between[vertex++] = jokers.test(x, y, z) ? 1 : 0;
      });
    }
    std::fill_n(between.begin() + static_cast<std::ptrdiff_t>(vertex),
                part.brick->other_vertices(), std::uint8_t{1});
  }
  return between;
}

std::uint64_t CountedLabels::bytes() const noexcept {
  std::uint64_t bytes = survey_.bytes + all_heap_bytes(first_vertex_, first_tet_);
  for (const OctreeLevel& level : tree_.levels) bytes += level.bytes();
  for (const LevelNodes& nodes : nodes_) bytes += nodes.bytes();
  for (const LevelLeaves& leaves : leaves_) bytes += all_heap_bytes(leaves.first, leaves.run);
  return bytes;
}

}  // namespace tet
