#include "core/plan/brick/counted_mesh.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <utility>

#include "core/base/brick_neighbours.h"
#include "core/base/parallel.h"
#include "core/lattice/reach.h"
#include "core/plan/brick/mesh_difference.h"
#include "core/plan/brick/unchanged_bricks.h"
#include "core/stuffing/count_tets.h"
#include "core/stuffing/surface_faces.h"

namespace tet {
namespace {

constexpr std::size_t kCountedPerRange = 16;  // the first of a range is searched for
constexpr std::array<MeshRegion, 2> kRegions{MeshRegion::kInside, MeshRegion::kOutside};

/// Some bricks of one level.
struct LevelRange {
  std::size_t level, begin, end;
};

/// All bricks of all levels, so that no level has to wait for another.
std::vector<LevelRange> ranges_of(const Octree& tree) {
  std::vector<LevelRange> ranges;
  for (std::size_t l = 0; l < tree.levels.size(); ++l) {
    const std::size_t bricks = tree.levels[l].bricks.size();
    for (std::size_t begin = 0; begin < bricks; begin += kCountedPerRange) {
      ranges.push_back({l, begin, std::min(bricks, begin + kCountedPerRange)});
    }
  }
  return ranges;
}

/// Which of the 27 around a brick is brick `o` of the eight beyond its upper faces.
constexpr std::size_t upper_place(std::size_t o) noexcept {
  return kItself + 9 * (o >> 2) + 3 * (o >> 1 & 1) + (o & 1);
}

}  // namespace

CountedMesh::CountedMesh(SurveyedMesh surveyed, const Cancellation& cancellation)
    : rules_(surveyed.rules),
      has_faces_(surveyed.faces),
      survey_(std::move(surveyed.survey)),
      tree_(std::move(surveyed.tree)) {
  const PhiField& field = surveyed.field;
  if (!surveyed.complete) {
    // In a uniform mesh of the inside every brick with a vertex is there already.
    if (!surveyed.uniform || rules_.both_sides) insert_corner_bricks(tree_.levels[0]);
    for (std::size_t l = 1; l < tree_.levels.size(); ++l) insert_corner_bricks(tree_.levels[l]);
  }
  find_stuffed(field, cancellation);
  std::vector<BrickPlaces> unchanged;
  const ComparedMesh* const earlier = surveyed.earlier;
  const CountedMesh* const before = earlier == nullptr ? nullptr : &earlier->mesh;
  if (before != nullptr) unchanged = find_unchanged_bricks(*before, *this);
  if (!cancellation.requested()) find_vertices(before, unchanged, cancellation);
  if (cancellation.requested()) return;
  if (before != nullptr) {
    const ComparedMesh now{*this, field};
    kept_ = find_kept_bricks({*earlier, now, PatchDetail::kBricks, cancellation},
                             std::move(unchanged));
    if (cancellation.requested()) return;
    earlier_serial_ = before->serial_;
  }
  count_bricks(cancellation, before, kept_);
  survey_.known = {};  // places in a survey that may be gone before this mesh is
}

std::uint64_t CountedMesh::next_serial() noexcept {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

CountedMesh::CountedMesh(MeshStructure structure, const StuffingRules& rules, bool faces)
    : rules_(rules),
      has_faces_(faces),
      geometry_is_trimmed_(true),
      survey_(std::move(structure.survey)),
      tree_(std::move(structure.tree)),
      stuffed_(std::move(structure.stuffed)) {
  find_cut_points();
  find_vertices(nullptr, {}, {});
  count_bricks({}, nullptr, {});
}

void CountedMesh::find_cut_points() {
  const std::vector<BrickCoord>& bricks = tree_.levels[0].bricks;
  for_each_range(bricks.size(), kCountedPerRange, [&](std::size_t begin, std::size_t end) {
    BrickNeighbours neighbours(bricks);
    for (std::size_t i = begin; i < end; ++i) {
      if (!touches_surface(i)) continue;
      survey_.stuffed[stuffed_[i]].cut = edges_cut(surroundings(neighbours.around(bricks[i])));
    }
  });
}

void CountedMesh::find_stuffed(const PhiField& field, const Cancellation& cancellation) {
  const std::vector<BrickCoord>& bricks = tree_.levels[0].bricks;
  stuffed_.resize(bricks.size());
  for_each_range(bricks.size(), kCountedPerRange, [&](std::size_t begin, std::size_t end) {
    PhiSampler sampler(field);
    // Both lists are sorted: their bricks are met in turn.
    auto surveyed =
        std::lower_bound(survey_.bricks.begin(), survey_.bricks.end(), bricks[begin]);
    for (std::size_t i = begin; i < end && !cancellation.requested(); ++i) {
      const BrickCoord b = bricks[i];
      while (surveyed != survey_.bricks.end() && *surveyed < b) ++surveyed;
      if (surveyed != survey_.bricks.end() && *surveyed == b) {
        stuffed_[i] = static_cast<std::uint32_t>(surveyed - survey_.bricks.begin());
        continue;
      }
      const bool inside =
          sampler.inside(std::int64_t{8} * b.x, std::int64_t{8} * b.y, std::int64_t{8} * b.z);
      stuffed_[i] = inside ? kAllInside : kAllOutside;
    }
  });
}

void CountedMesh::count_bricks(const Cancellation& cancellation,
                               const CountedMesh* earlier,
                               std::span<const KeptBricks> kept) {
  std::size_t bricks = 0;
  for (const OctreeLevel& level : tree_.levels) {
    first_brick_.push_back(bricks);
    bricks += level.bricks.size();
  }
  if (has_faces_ && rules_.both_sides) find_domain();
  std::vector<std::uint64_t> vertices(bricks), tets(bricks), faces(has_faces_ ? bricks : 0);
  const std::vector<LevelRange> ranges = ranges_of(tree_);
  for_each_index(ranges.size(), [&](std::size_t range) {
    if (cancellation.requested()) return;
    const auto [l, begin, end] = ranges[range];
    BrickNeighbours neighbours(tree_.levels[l].bricks);
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t brick = first_brick_[l] + i;
      // A tet that is kept may have another face.
      if (earlier != nullptr && kept[l].tets[i] != kNewBrick && !has_faces_) {
        const std::size_t before = earlier->first_brick_[l] + kept[l].tets[i];
        vertices[brick] = earlier->first_vertex_[before + 1] - earlier->first_vertex_[before];
        tets[brick] = earlier->first_tet_[before + 1] - earlier->first_tet_[before];
      } else {
        const BrickPlace place{static_cast<int>(l), i};
        vertices[brick] = vertices_of(place);
        const BrickCounts counts =
            counts_of(place, neighbours.around(tree_.levels[l].bricks[i]));
        tets[brick] = counts.tets;
        if (has_faces_) faces[brick] = counts.faces;
      }
    }
  });
  first_vertex_ = offsets_from_counts(bricks, [&](std::size_t i) { return vertices[i]; });
  first_tet_ = offsets_from_counts(bricks, [&](std::size_t i) { return tets[i]; });
  if (has_faces_) {
    first_face_ = offsets_from_counts(bricks, [&](std::size_t i) { return faces[i]; });
  }
  for (std::size_t l = 0; l < tree_.levels.size(); ++l) {
    const auto begin = first_vertex_.begin() + static_cast<std::ptrdiff_t>(first_brick_[l]);
    nodes_[l].first_vertex.assign(
        begin, begin + static_cast<std::ptrdiff_t>(tree_.levels[l].bricks.size()));
  }
}

BrickPlace CountedMesh::place(std::size_t brick) const noexcept {
  const auto level = std::upper_bound(first_brick_.begin(), first_brick_.end(), brick) - 1;
  return {static_cast<int>(level - first_brick_.begin()), brick - *level};
}

const StuffedBrick* CountedMesh::stuffed_at(std::uint32_t place) const noexcept {
  if (place == kNoBrick || stuffed_[place] == kAllOutside) return nullptr;
  return stuffed_[place] == kAllInside ? &all_inside_ : &survey_.stuffed[stuffed_[place]];
}

bool CountedMesh::touches_surface(std::size_t brick) const noexcept {
  return stuffed_[brick] < kAllInside;
}

std::uint64_t CountedMesh::bytes() const noexcept {
  std::uint64_t bytes =
      survey_.bytes() + all_heap_bytes(stuffed_, first_vertex_, first_tet_, first_face_);
  for (const OctreeLevel& level : tree_.levels) bytes += level.bytes();
  bytes += tree_.above.bytes();
  for (const LevelNodes& nodes : nodes_) {
    bytes += nodes.bytes();
  }
  for (const KeptBricks& kept : kept_) {
    bytes += all_heap_bytes(kept.vertices, kept.tets, kept.nodes) + kept.read.bytes();
  }
  return bytes;
}

BrickNeighbourhood CountedMesh::neighbourhood(std::size_t brick) const noexcept {
  const BrickCoord b = tree_.levels[0].bricks[brick];
  BrickNeighbourhood bricks;
  for (int o = 0; o < 8; ++o) {
    bricks[static_cast<std::size_t>(o)] = stuffed_at(
        tree_.levels[0].index.find({b.x + (o >> 2), b.y + (o >> 1 & 1), b.z + (o & 1)}));
  }
  return bricks;
}

BrickSurroundings CountedMesh::surroundings(const PlacesAround& around) const noexcept {
  BrickSurroundings bricks;
  std::ranges::transform(around, bricks.begin(),
                         [&](std::uint32_t place) { return stuffed_at(place); });
  return bricks;
}

std::span<const MeshRegion> CountedMesh::regions() const noexcept {
  return std::span(kRegions).first(rules_.both_sides ? 2 : 1);
}

OwnedVertices CountedMesh::vertices_of_finest(std::size_t brick) const noexcept {
  OwnedVertices vertices;
  vertices.node = {&nodes_[0].corner[brick], &nodes_[0].centre[brick]};
  // While vertices are counted there are no ids yet.
  if (!nodes_[0].first_vertex.empty()) vertices.first = nodes_[0].first_vertex[brick];
  const std::uint32_t at = stuffed_[brick];
  if (at == kAllInside) vertices.stuffed = &all_inside_;
  if (!touches_surface(brick)) return vertices;
  vertices.stuffed = &survey_.stuffed[at];
  vertices.at_surface = true;
  vertices.geometry = survey_.geometry.of_brick[at];
  if (rules_.both_sides) vertices.fans = &survey_.fans[at];
  return vertices;
}

VerticesAround CountedMesh::vertices_around(std::size_t brick) const noexcept {
  const OctreeLevel& finest = tree_.levels[0];
  return vertices_around(places_around(finest.index, finest.bricks[brick]));
}

VerticesAround CountedMesh::vertices_around(const PlacesAround& places) const noexcept {
  VerticesAround around;
  for (std::size_t o = 0; o < around.size(); ++o) {
    const std::uint32_t at = places[upper_place(o)];
    if (at != kNoBrick) around[o] = vertices_of_finest(at);
  }
  return around;
}

std::uint64_t CountedMesh::vertices_of(BrickPlace place) const noexcept {
  if (place.level == 0) {
    return vertices_of_finest(place.brick).count();
  }
  const LevelNodes& level = nodes(place.level);
  return std::uint64_t{level.corner[place.brick].count()} + level.centre[place.brick].count();
}

CountedMesh::BrickCounts CountedMesh::counts_of(BrickPlace place,
                                                const PlacesAround& around) const noexcept {
  const OctreeLevel& level = tree_.levels[static_cast<std::size_t>(place.level)];
  if (!level.leaf[place.brick].any()) return {};
  if (place.level == 0) return finest_counts_of(place.brick, around);
  // Only where both sides are meshed a coarser brick can have faces.
  const OuterCells outer = has_faces_ ? this->outer(place) : OuterCells{};
  BrickCounts counts;
  for (const MeshRegion region : regions()) {
    const BackgroundCells cells = gather_background(level, around, region);
    counts.tets += count_background(cells).total();
    if (any(outer)) counts.faces += count_background_faces(cells, outer);
  }
  return counts;
}

CountedMesh::BrickCounts CountedMesh::finest_counts_of(
    std::size_t brick, const PlacesAround& around) const noexcept {
  BrickNeighbourhood bricks;
  bool at_surface = false, all_minus = true;
  for (std::size_t o = 0; o < bricks.size(); ++o) {
    const std::uint32_t place = around[upper_place(o)];
    bricks[o] = stuffed_at(place);
    at_surface = at_surface || (place != kNoBrick && touches_surface(place));
    all_minus = all_minus && bricks[o] == nullptr;
  }
  if (all_minus && !rules_.both_sides) return {};
  CellNodes nodes = nodes_around_cells(bricks, leaves_around(tree_.levels[0].leaf, around));
  if (has_faces_) return count_with_faces(brick, around, at_surface, nodes);
  if (!rules_.both_sides) return {.tets = count_finest(nodes, nullptr)};
  const FanMasks* fans = vertices_of_finest(brick).fans;
  const std::uint64_t inside = count_finest(nodes, fans);
  see_from_outside(nodes);
  return {.tets = inside + count_finest(nodes, fans)};
}

CountedMesh::BrickCounts CountedMesh::count_with_faces(std::size_t brick,
                                                       const PlacesAround& around,
                                                       bool at_surface,
                                                       CellNodes& nodes) const noexcept {
  const FanMasks* fans = vertices_of_finest(brick).fans;
  const BrickSurroundings beside = surroundings(around);
  const OuterCells outer = this->outer({0, brick});
  const DomainFaces domain(outer, beside);
  const bool at_end = any(outer);
  BrickCounts counts;
  if (at_surface) {
    const FinestCounts inside =
        count_finest_with_faces(nodes, {beside, at_end ? &domain : nullptr}, fans);
    counts = {inside.tets, inside.triangles};
  } else {
    counts.tets = count_finest(nodes, fans);
  }
  if (at_end) counts.faces += domain.count(nodes);
  if (!rules_.both_sides) return counts;
  see_from_outside(nodes);
  counts.tets += count_finest(nodes, fans);
  if (at_end) counts.faces += domain.count(nodes);
  return counts;
}

void CountedMesh::find_domain() {
  for (std::size_t l = 0; l < tree_.levels.size(); ++l) {
    const OctreeLevel& level = tree_.levels[l];
    for (std::size_t i = 0; i < level.bricks.size(); ++i) {
      domain_.add(level.bricks[i], static_cast<int>(l), level.leaf[i]);
    }
  }
}

OuterCells CountedMesh::outer(BrickPlace place) const noexcept {
  if (!rules_.both_sides) return {};
  const OctreeLevel& level = tree_.levels[static_cast<std::size_t>(place.level)];
  return outer_cells(domain_, level.bricks[place.brick], place.level);
}

ChunkExtent CountedMesh::extent(const BrickRange& bricks) const noexcept {
  const auto [begin, end] = bricks;
  return {first_vertex(begin), first_vertex(end) - first_vertex(begin),
          first_tet(begin),    first_tet(end) - first_tet(begin),
          first_face(begin),   first_face(end) - first_face(begin)};
}

}  // namespace tet
