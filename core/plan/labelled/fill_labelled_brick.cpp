#include "core/plan/labelled/fill_labelled_brick.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "core/base/check.h"
#include "core/plan/brick/fill_brick.h"
#include "core/plan/brick/write_positions.h"

namespace tet {
namespace {

/// Writes the positions of vertices that are no nodes.
template <class Real>
void write_label_places(const BrickFrame& frame,
                        const LabelOwnPlaces& places,
                        std::span<std::byte> positions) noexcept {
  const auto [corner_x, corner_y, corner_z] = frame.corner();
  auto* out = reinterpret_cast<Real*>(positions.data());
  for (std::size_t i = 0; i < places.count; ++i) {
    const double px = corner_x + places.x[i], py = corner_y + places.y[i],
                 pz = corner_z + places.z[i];
    for (std::size_t r = 0; r < 3; ++r) {
      const std::array<double, 3>& row = frame.row(r);
      *out++ = static_cast<Real>(row[0] * px + row[1] * py + row[2] * pz);
    }
  }
  TET_CHECK(reinterpret_cast<std::byte*>(out) == positions.data() + positions.size());
}

template <class Index>
std::span<Index> as_ids(std::span<std::byte> column) noexcept {
  return {reinterpret_cast<Index*>(column.data()), column.size() / sizeof(Index)};
}

void write_labels(Label label, std::size_t count, std::byte* out) noexcept {
  for (std::size_t i = 0; i < count; ++i, out += sizeof(label)) {
    std::memcpy(out, &label, sizeof(label));
  }
}

}  // namespace

template <>
LabelIds<std::uint32_t>& LabelledBrickFiller::ids() {
  return scratch_.ids32;
}

template <>
LabelIds<std::uint64_t>& LabelledBrickFiller::ids() {
  if (!scratch_.ids64) {
    scratch_.ids64 = std::make_unique_for_overwrite<LabelIds<std::uint64_t>>();
  }
  return *scratch_.ids64;
}

void LabelledBrickFiller::fill(std::size_t brick, const ChunkColumns& columns) {
  if (filled_++ % kBricksPerRun == 0 && filled_ > 1) {
    runs_.add(stats_of_run());
    meter_ = {};
    background_ = {};
  }
  const BrickPlace place = mesh_.place(brick);
  const PlacesAround& around = neighbours_of(place);
  const bool narrow = header_.index_type == IndexType::kUint32;
  if (place.level == 0) {
    narrow ? fill_finest<std::uint32_t>(place.brick, around, columns)
           : fill_finest<std::uint64_t>(place.brick, around, columns);
  } else {
    narrow ? fill_coarse<std::uint32_t>(place, around, columns)
           : fill_coarse<std::uint64_t>(place, around, columns);
  }
}

const PlacesAround& LabelledBrickFiller::neighbours_of(BrickPlace place) {
  const auto& bricks = mesh_.tree().levels[static_cast<std::size_t>(place.level)].bricks;
  if (place.level != last_.level || place.brick < last_.brick) {
    neighbours_ = BrickNeighbours(bricks);
  }
  last_ = place;
  return neighbours_.around(bricks[place.brick]);
}

template <class Index>
void LabelledBrickFiller::fill_finest(std::size_t brick,
                                      const PlacesAround& around,
                                      const ChunkColumns& columns) {
  LabelledParts parts = mesh_.parts(around);
  // A brick without tets uses no others' vertices.
  if (columns.tets.empty()) std::fill(parts.begin() + 1, parts.end(), LabelledPart{});
  scratch_.vertices.enter(parts, ids<Index>());
  write_finest_positions(brick, parts[0], columns.positions);
  if (columns.tets.empty()) return;
  const FilledLabels filled =
      LabelFiller(scratch_.fill)
          .fill(
              {scratch_.vertices, LeafFaces(leaves_around(mesh_.tree().levels[0].leaf, around)),
               parts[0], mesh_.rules().kept},
              ids<Index>(), as_ids<Index>(columns.tets), columns.regions);
  mirror<Index>(columns.tets);
  if (statistics_ != Statistics::kMeasured) return;
  meter_.add_tets(scratch_.vertices.points(), filled.divided);
  background_.add(filled.counts, 0);
}

void LabelledBrickFiller::write_finest_positions(std::size_t brick,
                                                 const LabelledPart& own,
                                                 std::span<std::byte> positions) const {
  StuffedBrick jokers;
  OwnedVertices nodes{.node = own.node};
  if (own.brick != nullptr) {
    jokers.zero = own.brick->joker;
    nodes.stuffed = &jokers;
    nodes.at_surface = true;
  }
  const BrickFrame frame(to_world_, mesh_.tree().levels[0].bricks[brick], 0);
  const LabelOwnPlaces& others = scratch_.vertices.other_places();
  const std::size_t bytes = others.count * 3 * size_of(header_.coordinate_type);
  write_positions(frame, nodes, scratch_.vertices.joker_places(), header_.coordinate_type,
                  positions.first(positions.size() - bytes));
  if (header_.coordinate_type == CoordinateType::kFloat32) {
    write_label_places<float>(frame, others, positions.last(bytes));
  } else {
    write_label_places<double>(frame, others, positions.last(bytes));
  }
}

template <class Index>
void LabelledBrickFiller::fill_coarse(BrickPlace place,
                                      const PlacesAround& around,
                                      const ChunkColumns& columns) {
  const OctreeLevel& level = mesh_.tree().levels[static_cast<std::size_t>(place.level)];
  const BrickCoord brick = level.bricks[place.brick];
  const LevelNodes& nodes = mesh_.nodes(place.level);
  write_positions(BrickFrame(to_world_, brick, place.level),
                  {.node = {&nodes.corner[place.brick], &nodes.centre[place.brick]}},
                  scratch_.vertices.joker_places(), header_.coordinate_type, columns.positions);
  if (columns.tets.empty()) return;
  BackgroundCells cells = gather_background(level, around, MeshRegion::kInside);
  BackgroundCounts counts;
  const std::span<Index> tets = as_ids<Index>(columns.tets);
  Index* out = tets.data();
  for (const LabelLeaves& leaves : mesh_.leaves_of(place)) {
    cells.own = leaves.cells;
    Index* const begin = out;
    out = fill_background(cells, numbers_, place.level, brick, begin, counts);
    write_labels(leaves.label, static_cast<std::size_t>(out - begin) / 4,
                 columns.regions.data() +
                     static_cast<std::size_t>(begin - tets.data()) / 4 * sizeof(Label));
  }
  TET_CHECK(out == tets.data() + tets.size());
  mirror<Index>(columns.tets);
  if (statistics_ == Statistics::kMeasured) {
    background_.add(counts, place.level);
  }
}

/// Where the map to the world mirrors, two nodes of every tet change places.
template <class Index>
void LabelledBrickFiller::mirror(std::span<std::byte> column) const noexcept {
  if (!to_world_.mirrors) return;
  const std::span<Index> tets = as_ids<Index>(column);
  for (std::size_t i = 0; i < tets.size(); i += 4) std::swap(tets[i + 2], tets[i + 3]);
}

QualityStats LabelledBrickFiller::stats() const noexcept {
  QualityStats stats = runs_;
  stats.add(stats_of_run());
  return stats;
}

QualityStats LabelledBrickFiller::stats_of_run() const noexcept {
  QualityStats stats = meter_.stats();
  stats.add(background_.stats());
  stats.volume *= volume_scale(to_world_);
  return stats;
}

}  // namespace tet
