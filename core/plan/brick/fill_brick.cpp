#include "core/plan/brick/fill_brick.h"

#include <algorithm>
#include <utility>

#include "core/base/check.h"
#include "core/base/vec3.h"
#include "core/plan/brick/kept_tets.h"

namespace tet {

template <>
SlotIds<std::uint32_t>& BrickFiller::ids() noexcept {
  return workspace_.ids32;
}

template <>
SlotIds<std::uint64_t>& BrickFiller::ids() noexcept {
  if (!workspace_.ids64) {
    workspace_.ids64 = std::make_unique_for_overwrite<SlotIds<std::uint64_t>>();
  }
  return *workspace_.ids64;
}

void BrickFiller::stop_when(const Cancellation& cancellation) noexcept {
  cancellation_ = &cancellation;
  sampler_.stop_when(cancellation);
  labeller_.stop_when(cancellation);
}

void BrickFiller::fill(std::size_t brick,
                       const ChunkColumns& columns,
                       const BrickMask* cells) noexcept {
  if (filled_++ % kBricksPerRun == 0 && filled_ > 1) {
    runs_.add(stats_of_run());
    meter_ = {};
    background_ = {};
  }
  const BrickPlace place = mesh_.place(brick);
  const OctreeLevel& level = mesh_.tree().levels[static_cast<std::size_t>(place.level)];
  const PlacesAround& places = neighbours_of(place);
  if (place.level == 0) {
    around_ = mesh_.vertices_around(places);
    // A brick without tets uses no others' vertices.
    if (mesh_.first_tet(brick + 1) == mesh_.first_tet(brick)) {
      std::fill(around_.begin() + 1, around_.end(), OwnedVertices{});
    }
    if (!find_vertices(place.brick)) return;
  } else {
    const LevelNodes& nodes = mesh_.nodes(place.level);
    around_[0] = {.node = {&nodes.corner[place.brick], &nodes.centre[place.brick]}};
  }
  const BrickFrame frame(to_world_, level.bricks[place.brick], place.level);
  write_positions(frame, around_[0], workspace_.vertices.own_places(), header_.coordinate_type,
                  columns.positions);
  if (columns.tets.empty()) return;
  has_faces_ = !columns.faces.empty();
  workspace_.faces.clear();
  if (has_faces_) {
    outer_ = mesh_.outer(place);
    if (place.level == 0) surroundings_ = mesh_.surroundings(places);
    if (!labeller_.empty()) focus_labeller(frame);
  }
  const std::uint64_t first_tet = mesh_.first_tet(brick);
  if (header_.index_type == IndexType::kUint32) {
    fill_tets<std::uint32_t>(place, places, cells, columns);
    write_faces<std::uint32_t>(first_tet, columns);
  } else {
    fill_tets<std::uint64_t>(place, places, cells, columns);
    write_faces<std::uint64_t>(first_tet, columns);
  }
}

/// Bricks come in the order of ids, but for a caller who has more than one run of them.
const PlacesAround& BrickFiller::neighbours_of(BrickPlace place) noexcept {
  const auto& bricks = mesh_.tree().levels[static_cast<std::size_t>(place.level)].bricks;
  if (place.level != last_.level || place.brick < last_.brick) {
    neighbours_ = BrickNeighbours(bricks);
  }
  last_ = place;
  return neighbours_.around(bricks[place.brick]);
}

/// Numbers the vertices that a finest brick's tets use, and places them. False where their
/// places may be made up: columns were counted for those that there are.
bool BrickFiller::find_vertices(std::size_t brick) noexcept {
  if (std::any_of(around_.begin(), around_.end(), [](const OwnedVertices& vertices) {
        return vertices.at_surface && vertices.geometry == nullptr;
      })) {
    find_geometry(brick);
    if (cancellation_ != nullptr && cancellation_->requested()) return false;
  }
  if (header_.index_type == IndexType::kUint32) {
    workspace_.vertices.enter(around_, ids<std::uint32_t>());
  } else {
    workspace_.vertices.enter(around_, ids<std::uint64_t>());
  }
  return true;
}

/// Stuffs a brick again, where its geometry or that of a brick around it was not kept.
void BrickFiller::find_geometry(std::size_t brick) noexcept {
  stuff_brick(sampler_, mesh_.tree().levels[0].bricks[brick], mesh_.rules(), mesh_.restored(),
              workspace_.stuffing);
  if (cancellation_ != nullptr && cancellation_->requested()) return;
  for (std::size_t o = 0; o < around_.size(); ++o) {
    OwnedVertices& vertices = around_[o];
    if (!vertices.at_surface || vertices.geometry != nullptr) continue;
    std::byte* const packed = workspace_.geometry[o].data();
    pack_geometry_in_reach(workspace_.stuffing.lattice, *vertices.stuffed, o, packed);
    vertices.geometry = packed;
  }
}

template <class Index>
void BrickFiller::fill_tets(BrickPlace place,
                            const PlacesAround& places,
                            const BrickMask* cells,
                            const ChunkColumns& columns) noexcept {
  auto* const begin = reinterpret_cast<Index*>(columns.tets.data());
  Index* end = begin;
  const Index* const limit = begin + columns.tets.size() / sizeof(Index);
  std::span<std::byte> labels = columns.regions;
  if (place.level == 0) nodes_ = nodes_of(places);
  if (cells != nullptr) leave_tets_of(*cells, nodes_);
  for (const MeshRegion region : mesh_.regions()) {
    Index* const first = end;
    const auto before = static_cast<std::size_t>(first - begin) / 4;
    end = place.level == 0 ? fill_finest_tets(region, first, limit, before)
                           : fill_background_tets(place, places, region, first, before);
    if (labels.empty()) continue;
    const auto tets = static_cast<std::size_t>(end - first) / 4;
    std::fill_n(labels.begin(), tets, static_cast<std::byte>(region));
    labels = labels.subspan(tets);
  }
  TET_CHECK(reinterpret_cast<std::byte*>(end) == columns.tets.data() + columns.tets.size());
  if (!to_world_.mirrors) return;
  for (Index* tet = begin; tet != end; tet += 4) std::swap(tet[2], tet[3]);
}

/// Writes the faces that were noted while the tets were made.
template <class Index>
void BrickFiller::write_faces(std::uint64_t first_tet, const ChunkColumns& columns) noexcept {
  if (!has_faces_) return;
  if (to_world_.mirrors) workspace_.faces.mirror();
  if (any(outer_)) workspace_.faces.sort();
  const std::span<const LocalFace> noted = workspace_.faces.all();
  const std::size_t counted = columns.face_labels.size() / sizeof(std::uint16_t);
  TET_CHECK(noted.size() == counted);
  // What a server says of its bricks must not write beyond the columns.
  const std::span<const LocalFace> faces = noted.first(std::min(noted.size(), counted));
  const auto* const tets = reinterpret_cast<const Index*>(columns.tets.data());
  auto* ids = reinterpret_cast<Index*>(columns.faces.data());
  auto* of_tet = reinterpret_cast<Index*>(columns.face_tets.data());
  for (const LocalFace& face : faces) {
    // Read before anything is written: compilers cannot know that nothing lies on top.
    const std::size_t number = face.tet;
    const auto& [a, b, c] = kFaceCorners[face.opposite];
    const Index* const tet = tets + 4 * number;
    const std::array<Index, 3> triangle{tet[a], tet[b], tet[c]};
    ids = std::ranges::copy(triangle, ids).out;
    *of_tet++ = static_cast<Index>(first_tet + number);
  }
  auto* label = reinterpret_cast<std::uint16_t*>(columns.face_labels.data());
  if (labeller_.empty()) {
    std::ranges::transform(faces, label, &LocalFace::label);
    return;
  }
  for (const LocalFace& face : faces) {
    *label++ = face.label == 0 ? labeller_.label_of(place_of(face)) : face.label;
  }
}

/// Looks at a finest brick, and at the cells around it that its tets reach.
void BrickFiller::focus_labeller(const BrickFrame& frame) noexcept {
  constexpr double kMiddle = kBrickEdge / 2.0, kReach = kMiddle + 2;
  corner_ = frame.corner();
  labeller_.focus(world_of({kMiddle, kMiddle, kMiddle}), kReach * header_.spacing);
}

FacePlace BrickFiller::place_of(const LocalFace& face) const noexcept {
  FacePlace place;
  for (std::size_t i = 0; i < place.size(); ++i) {
    const auto [x, y, z] =
        workspace_.vertices.points()[face.corners[kFaceCorners[face.opposite][i]]];
    place[i] = world_of({x, y, z});
  }
  return place;
}

/// Takes spacings from the brick's lowest corner.
WorldPoint BrickFiller::world_of(const WorldPoint& lattice) const noexcept {
  const Triple at{corner_[0] + lattice.x, corner_[1] + lattice.y, corner_[2] + lattice.z};
  const auto& linear = to_world_.linear;
  return {header_.origin.x + dot(linear[0], at), header_.origin.y + dot(linear[1], at),
          header_.origin.z + dot(linear[2], at)};
}

CellNodes BrickFiller::nodes_of(const PlacesAround& places) const noexcept {
  BrickNeighbourhood signs;
  for (std::size_t o = 0; o < signs.size(); ++o) signs[o] = around_[o].stuffed;
  return nodes_around_cells(signs, leaves_around(mesh_.tree().levels[0].leaf, places));
}

template <class Index>
Index* BrickFiller::fill_finest_tets(MeshRegion region,
                                     Index* out,
                                     const Index* limit,
                                     std::size_t tets) noexcept {
  if (region == MeshRegion::kOutside) see_from_outside(nodes_);
  StuffedTets& stuffed = workspace_.stuffed_tets;
  stuffed.clear();
  BackgroundCounts counts;
  const DomainFaces domain(outer_, surroundings_);
  const FacesOfBrick faces{
      {surroundings_, any(outer_) ? &domain : nullptr}, workspace_.faces, tets};
  out = fill_finest(
      {nodes_, workspace_.vertices, mesh_.rules(), statistics_, has_faces_ ? &faces : nullptr},
      ids<Index>(), out, limit, stuffed, counts);
  if (statistics_ == Statistics::kMeasured) {
    meter_.add_tets(workspace_.vertices.points(), stuffed.from(0));
    background_.add(counts, 0);
  }
  return out;
}

template <class Index>
Index* BrickFiller::fill_background_tets(BrickPlace place,
                                         const PlacesAround& places,
                                         MeshRegion region,
                                         Index* out,
                                         std::size_t tets) noexcept {
  const OctreeLevel& level = mesh_.tree().levels[static_cast<std::size_t>(place.level)];
  const BrickCoord brick = level.bricks[place.brick];
  const BackgroundCells cells = gather_background(level, places, region);
  BackgroundCounts counts;
  out = fill_background(cells, numbers_, place.level, brick, out, counts);
  if (has_faces_) add_background_faces(cells, outer_, tets, workspace_.faces);
  if (statistics_ == Statistics::kMeasured) background_.add(counts, place.level);
  return out;
}

QualityStats BrickFiller::stats() const noexcept {
  QualityStats stats = runs_;
  stats.add(stats_of_run());
  return stats;
}

QualityStats BrickFiller::stats_of_run() const noexcept {
  QualityStats stats = meter_.stats();
  stats.add(background_.stats());
  stats.volume *= volume_scale(to_world_);
  return stats;
}

}  // namespace tet
