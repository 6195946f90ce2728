#include "core/plan/joined/joined_plan.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <utility>

#include <absl/strings/escaping.h>
#include <absl/strings/str_format.h>

#include "core/plan/brick/fill_brick.h"
#include "core/plan/budget.h"
#include "core/plan/mesh_place.h"
#include "core/plan/prepared_mesh.h"
#include "core/plan/request_rules.h"

namespace tet {
namespace {

using Plan = std::shared_ptr<const MeshPlan>;

constexpr std::size_t kShownBytes = 100;  // of a name, in a message

std::string shown(const std::string& name) {
  return absl::CHexEscape(name.substr(0, kShownBytes));
}

/// Less what is used already.
std::uint64_t left_of(std::uint64_t all, std::uint64_t used) {
  return all - std::min(all, used);
}

std::vector<std::string> names_of(const GridList& grids) {
  std::vector<std::string> names;
  for (const auto& grid : grids) names.push_back(grid->name);
  return names;
}

/// Plans the meshes of all grids so that they can be stored as one.
class PartPlanner {
 public:
  PartPlanner(const GridList& grids,
              const MeshRequest& request,
              const MeshLimits& limits,
              const Cancellation& cancellation,
              MeshProgress* progress)
      : grids_(grids),
        request_(request),
        limits_(limits),
        cancellation_(cancellation),
        progress_(progress),
        plans_(grids.size()) {}

  absl::StatusOr<std::vector<Plan>> plan_all();

  /// Its lattice is another than the first grid's.
  bool is_moved(std::size_t i) const {
    return !(grids_[i]->transform == grids_.front()->transform);
  }

 private:
  absl::Status look_at_all();
  absl::Status plan(std::size_t i);
  absl::Status store_alike();
  bool is_far(std::size_t i) const;
  MeshLimits limits_left() const;
  std::uint64_t planned_tets() const;
  absl::Status about_grid(const absl::Status& status, std::size_t i) const;

  const GridList& grids_;
  MeshRequest request_;  ///< as it is understood so far
  const MeshLimits& limits_;
  const Cancellation& cancellation_;
  MeshProgress* const progress_;
  std::vector<Plan> plans_;  ///< null where there is none yet
};

absl::StatusOr<std::vector<Plan>> PartPlanner::plan_all() {
  if (auto status = look_at_all(); !status.ok()) return status;
  for (std::size_t i = 0; i < grids_.size(); ++i) {
    if (auto status = plan(i); !status.ok()) return status;
    request_.origin = plans_.front()->header().origin;
  }
  if (auto status = store_alike(); !status.ok()) return status;
  return std::move(plans_);
}

/// What can be refused is refused before the first grid is surveyed, and it is known how many
/// bricks there are.
absl::Status PartPlanner::look_at_all() {
  std::uint64_t bricks = 0;
  for (std::size_t i = 0; i < grids_.size(); ++i) {
    const auto prepared = prepare_mesh(grids_[i], request_, limits_, cancellation_);
    if (!prepared.ok()) return about_grid(prepared.status(), i);
    bricks += prepared->bricks.near_surface.size();
  }
  const std::uint64_t most = most_surface_bricks(stuffing_rules(request_.preset), limits_);
  if (bricks > most) {
    return absl::ResourceExhaustedError(absl::StrFormat(
        "%d bricks of 8^3 cells lie near the surfaces of %d grids; the limit is %d, as many as "
        "the memory for counting a mesh holds. Use a larger spacing or fewer grids",
        bricks, grids_.size(), most));
  }
  // What is made as a whole is not surveyed.
  if (progress_ != nullptr && !is_made_whole(request_)) progress_->expect(bricks);
  return absl::OkStatus();
}

absl::Status PartPlanner::plan(std::size_t i) {
  MeshRequest request = request_;
  if (is_moved(i)) request.coordinates = CoordinateType::kFloat64;
  plans_[i].reset();
  auto plan = plan_mesh(grids_[i], request, limits_left(), cancellation_, progress_);
  if (!plan.ok()) return about_grid(plan.status(), i);
  plans_[i] = *std::move(plan);
  return absl::OkStatus();
}

/// All with the same types of coordinates and ids: those that the largest of them and all
/// together need. Others were right nearly always.
absl::Status PartPlanner::store_alike() {
  std::uint64_t vertices = 0;
  bool any_is_far = false;
  for (std::size_t i = 0; i < plans_.size(); ++i) {
    vertices += plans_[i]->header().vertex_count;
    any_is_far = any_is_far || is_far(i);
  }
  if (!request_.coordinates && any_is_far) request_.coordinates = CoordinateType::kFloat64;
  if (vertices > std::numeric_limits<std::uint32_t>::max()) {
    request_.indices = IndexType::kUint64;
  }
  for (std::size_t i = 0; i < plans_.size(); ++i) {
    const MeshHeader& header = plans_[i]->header();
    const bool same_ids = header.index_type == request_.indices.value_or(IndexType::kUint32);
    const bool same_places =
        is_moved(i) ||
        header.coordinate_type == request_.coordinates.value_or(CoordinateType::kFloat32);
    if (same_ids && same_places) continue;
    if (auto status = plan(i); !status.ok()) return status;
  }
  return absl::OkStatus();
}

/// Whether float32 does not do from the shared origin on.
bool PartPlanner::is_far(std::size_t i) const {
  const MeshHeader& header = plans_[i]->header();
  if (!is_moved(i)) return header.coordinate_type == CoordinateType::kFloat64;
  return tet::is_far(header.bounds, *request_.origin, header.spacing);
}

MeshLimits PartPlanner::limits_left() const {
  std::uint64_t bytes = 0;
  for (const Plan& plan : plans_) bytes += plan == nullptr ? 0 : plan->bytes();
  MeshLimits left = limits_;
  left.max_tets = left_of(limits_.max_tets, planned_tets());
  left.max_plan_bytes = left_of(limits_.max_plan_bytes, bytes);
  left.kept_geometry_bytes = left_of(limits_.kept_geometry_bytes, bytes);
  return left;
}

std::uint64_t PartPlanner::planned_tets() const {
  std::uint64_t tets = 0;
  for (const Plan& plan : plans_) tets += plan == nullptr ? 0 : plan->header().tet_count;
  return tets;
}

/// The name comes last: what is wrong with a field of the request is known by how it begins.
absl::Status PartPlanner::about_grid(const absl::Status& status, std::size_t i) const {
  if (absl::IsCancelled(status) || absl::IsDeadlineExceeded(status)) return status;
  std::string grid = absl::StrFormat("grid '%s'", shown(grids_[i]->name));
  if (absl::IsResourceExhausted(status)) {
    absl::StrAppendFormat(&grid, ", beside %d tets of other grids", planned_tets());
  }
  return {status.code(), absl::StrFormat("%s (%s)", status.message(), grid)};
}

template <class Id>
void add_to_ids(std::span<std::byte> ids, std::uint64_t first) noexcept {
  for (std::size_t i = 0; i < ids.size(); i += sizeof(Id)) {
    Id id = 0;
    std::memcpy(&id, &ids[i], sizeof(id));
    id += static_cast<Id>(first);
    std::memcpy(&ids[i], &id, sizeof(id));
  }
}

/// From doubles.
template <class Number>
void store_moved(std::span<const std::byte> places,
                 const WorldPoint& move,
                 std::span<std::byte> positions) noexcept {
  constexpr std::size_t kFrom = 3 * sizeof(double), kTo = 3 * sizeof(Number);
  for (std::size_t i = 0; i < places.size() / kFrom; ++i) {
    std::array<double, 3> p;
    std::memcpy(p.data(), &places[i * kFrom], kFrom);
    const std::array<Number, 3> moved{static_cast<Number>(p[0] + move.x),
                                      static_cast<Number>(p[1] + move.y),
                                      static_cast<Number>(p[2] + move.z)};
    std::memcpy(&positions[i * kTo], moved.data(), kTo);
  }
}

WorldBox box_around(const WorldBox& a, const WorldBox& b) {
  return {{std::min(a.min.x, b.min.x), std::min(a.min.y, b.min.y), std::min(a.min.z, b.min.z)},
          {std::max(a.max.x, b.max.x), std::max(a.max.y, b.max.y), std::max(a.max.z, b.max.z)}};
}

}  // namespace

absl::Status check_grid_names(std::span<const std::string> names) {
  if (names.empty() || names.size() > kMaxMeshParts) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "%s has %d entries; it takes 1 to %d", kGridNamesField, names.size(), kMaxMeshParts));
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].empty()) {
      return absl::InvalidArgumentError(
          absl::StrFormat("%s[%d] is empty: name the grid", kGridNamesField, i));
    }
    const auto other = std::find(names.begin(), names.end(), names[i]) - names.begin();
    if (static_cast<std::size_t>(other) == i) continue;
    return absl::InvalidArgumentError(
        absl::StrFormat("%s[%d] '%s' is %s[%d], too: name it once", kGridNamesField, i,
                        shown(names[i]), kGridNamesField, other));
  }
  return absl::OkStatus();
}

absl::StatusOr<JoinedPlan> JoinedPlan::of(const GridList& grids,
                                          const MeshRequest& request,
                                          const MeshLimits& limits,
                                          const Cancellation& cancellation,
                                          MeshProgress* progress) {
  const std::vector<std::string> names = names_of(grids);
  absl::Status status = check_grid_names(names);
  if (status.ok()) {
    status =
        check_features(features_of(request).add(Feature::kSeveralGrids), field_names(request));
  }
  if (!status.ok()) return status;
  PartPlanner planner(grids, request, limits, cancellation, progress);
  auto plans = planner.plan_all();
  if (!plans.ok()) return plans.status();
  JoinedPlan joined;
  for (std::size_t i = 0; i < names.size(); ++i) {
    joined.add(names[i], std::move((*plans)[i]), planner.is_moved(i));
  }
  return joined;
}

void JoinedPlan::add(const std::string& name, Plan plan, bool is_moved) {
  const MeshHeader& of = plan->header();
  Part part{plan, std::nullopt, header_.chunk_count, header_.vertex_count, header_.tet_count};
  if (parts_.empty()) {
    header_ = of;
    header_.vertex_count = header_.tet_count = header_.chunk_count = 0;
  }
  if (is_moved) {
    const WorldPoint& to = header_.origin;
    part.move = {of.origin.x - to.x, of.origin.y - to.y, of.origin.z - to.z};
  }
  header_.parts.push_back({name, part.first_vertex, of.vertex_count, part.first_tet,
                           of.tet_count, of.spacing, of.levels});
  header_.vertex_count += of.vertex_count;
  header_.tet_count += of.tet_count;
  header_.chunk_count += of.chunk_count;
  header_.bounds = box_around(header_.bounds, of.bounds);
  header_.spacing = std::min(header_.spacing, of.spacing);
  header_.levels = std::max(header_.levels, of.levels);
  parts_.push_back(std::move(part));
}

ThinWalls JoinedPlan::thin_walls() const {
  ThinWalls all;
  for (const Part& part : parts_) {
    const ThinWalls& walls = part.plan->thin_walls();
    if (!walls.any()) continue;
    all.thickness = all.any() ? std::min(all.thickness, walls.thickness) : walls.thickness;
    all.suggested_spacing = all.any() ? std::min(all.suggested_spacing, walls.suggested_spacing)
                                      : walls.suggested_spacing;
    all.inside += walls.inside;
    all.outside += walls.outside;
    all.region_count += walls.region_count;
    all.regions.insert(all.regions.end(), walls.regions.begin(), walls.regions.end());
  }
  std::ranges::stable_sort(all.regions, [](const auto& a, const auto& b) {
    return a.inside + a.outside > b.inside + b.outside;
  });
  all.regions.resize(std::min(all.regions.size(), ThinWalls::kMaxRegions));
  return all;
}

std::optional<BoundaryTopology> JoinedPlan::boundary() const {
  BoundaryTopology all;
  for (const Part& part : parts_) {
    const std::optional<BoundaryTopology>& boundary = part.plan->boundary();
    if (!boundary) return std::nullopt;
    all.triangles += boundary->triangles;
    all.vertices += boundary->vertices;
    all.components += boundary->components;
    all.euler_characteristic += boundary->euler_characteristic;
    all.non_manifold_edges += boundary->non_manifold_edges;
    all.non_manifold_vertices += boundary->non_manifold_vertices;
    all.restored_nodes += boundary->restored_nodes;
  }
  return all;
}

std::optional<Improvement> JoinedPlan::improvement() const {
  Improvement all;
  for (const Part& part : parts_) {
    const std::optional<Improvement>& one = part.plan->improvement();
    if (!one) return std::nullopt;
    all.min_dihedral_before_deg =
        std::min(all.min_dihedral_before_deg, one->min_dihedral_before_deg);
    all.max_dihedral_before_deg =
        std::max(all.max_dihedral_before_deg, one->max_dihedral_before_deg);
    all.moved_vertices += one->moved_vertices;
    all.seconds += one->seconds;
  }
  return all;
}

const JoinedPlan::Part& JoinedPlan::part_of(std::uint64_t chunk) const noexcept {
  const auto after = std::ranges::upper_bound(parts_, chunk, {}, &Part::first_chunk);
  return *(after - 1);
}

ChunkExtent JoinedPlan::chunk(std::uint64_t index) const noexcept {
  const Part& part = part_of(index);
  ChunkExtent chunk = part.plan->chunk(index - part.first_chunk);
  chunk.first_vertex += part.first_vertex;
  chunk.first_tet += part.first_tet;
  return chunk;
}

QualityStats JoinedPlan::fill_chunk(std::uint64_t index,
                                    MeshWorkspace& workspace,
                                    ChunkColumns columns) const noexcept {
  const Part& part = part_of(index);
  ChunkColumns own = columns;
  if (part.move) {
    std::vector<std::byte>& places = workspace.impl().places;
    places.resize(columns.positions.size() / size_of(header_.coordinate_type) * sizeof(double));
    own.positions = places;
  }
  const QualityStats stats = part.plan->fill_chunk(index - part.first_chunk, workspace, own);
  if (part.move && header_.coordinate_type == CoordinateType::kFloat64) {
    store_moved<double>(own.positions, *part.move, columns.positions);
  } else if (part.move) {
    store_moved<float>(own.positions, *part.move, columns.positions);
  }
  if (header_.index_type == IndexType::kUint64) {
    add_to_ids<std::uint64_t>(columns.tets, part.first_vertex);
  } else {
    add_to_ids<std::uint32_t>(columns.tets, part.first_vertex);
  }
  return stats;
}

std::uint64_t JoinedPlan::bytes() const noexcept {
  std::uint64_t bytes = 0;
  for (const Part& part : parts_) bytes += part.plan->bytes();
  return bytes;
}

}  // namespace tet
