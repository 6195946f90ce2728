#include "core/plan/joined/joined_plan.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <utility>

#include <absl/strings/escaping.h>
#include <absl/strings/str_format.h>

#include "core/mesh/find_faces.h"
#include "core/octree/leaf_rules.h"
#include "core/plan/budget.h"
#include "core/plan/check_face_regions.h"
#include "core/plan/fill_watch.h"
#include "core/plan/mesh_place.h"
#include "core/plan/mesh_progress.h"
#include "core/plan/mesh_workspace.h"
#include "core/plan/prepared_mesh.h"
#include "core/plan/request_rules.h"

namespace tet {
namespace {

using Plan = std::shared_ptr<const MeshPlan>;

constexpr std::size_t kShownBytes = 100;  // of a name, in a message

std::string shown(const std::string& name) {
  return absl::CHexEscape(name.substr(0, kShownBytes));
}

/// What is left of a limit when so much of it is used already.
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
  PartPlanner(const PlanJob& job, const PlanOne& plan_one, const Cancellation& cancellation)
      : job_(job),
        plan_one_(plan_one),
        cancellation_(cancellation),
        grids_(*grids_of(job.shape)),
        request_(job.request),
        plans_(grids_.size()) {}

  absl::StatusOr<std::vector<Plan>> plan_all();

  /// Whether the grid has another lattice than the first one.
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

  const PlanJob& job_;
  const PlanOne& plan_one_;
  const Cancellation& cancellation_;
  const GridList& grids_;
  MeshRequest request_;      ///< as it is understood so far
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
  std::uint64_t bricks = 0, most = kMaxSurfaceBricks;
  for (std::size_t i = 0; i < grids_.size(); ++i) {
    const auto prepared = prepare_mesh(grids_[i], request_, job_.limits, cancellation_);
    if (!prepared.ok()) return about_grid(prepared.status(), i);
    bricks += prepared->bricks.near_surface.size();
    most = std::min<std::uint64_t>(
        most, most_found_bricks(prepared->field, prepared->space, job_.limits));
  }
  if (bricks > most) {
    return absl::ResourceExhaustedError(absl::StrFormat(
        "%d bricks of 8^3 cells lie near the surfaces of %d grids; the limit is %d, as many as "
        "the memory for counting a mesh holds. Use a larger spacing or fewer grids",
        bricks, grids_.size(), most));
  }
  // What is made as a whole is not surveyed.
  if (job_.progress != nullptr && !is_made_whole(request_)) job_.progress->expect(bricks);
  return absl::OkStatus();
}

absl::Status PartPlanner::plan(std::size_t i) {
  PlanJob one{.shape = grids_[i], .request = request_, .progress = job_.progress};
  if (is_moved(i)) one.request.coordinates = CoordinateType::kFloat64;
  plans_[i].reset();
  one.limits = limits_left();
  auto plan = plan_one_(one);
  if (!plan.ok()) return about_grid(plan.status(), i);
  plans_[i] = *std::move(plan);
  return absl::OkStatus();
}

/// Has all stored with the same types of coordinates and ids: those that the largest of them
/// and all together need. Nearly always they are already.
absl::Status PartPlanner::store_alike() {
  std::uint64_t vertices = 0;
  bool any_is_far = false;
  for (std::size_t i = 0; i < plans_.size(); ++i) {
    vertices += plans_[i]->header().vertex_count;
    any_is_far = any_is_far || is_far(i);
  }
  if (!request_.coordinates && any_is_far) request_.coordinates = CoordinateType::kFloat64;
  MeshHeader all = plans_.front()->header();
  all.vertex_count = vertices;
  all.tet_count = planned_tets();
  if (index_type_of(all, request_) == IndexType::kUint64) request_.indices = IndexType::kUint64;
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
  MeshLimits left = job_.limits;
  left.max_tets = left_of(left.max_tets, planned_tets());
  left.max_plan_bytes = left_of(left.max_plan_bytes, bytes);
  left.kept_geometry_bytes = left_of(left.kept_geometry_bytes, bytes);
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

/// Turns the numbers that a part's chunk has alone into those of the whole mesh.
template <class Id>
void number_on(const JoinedPart& part, const ChunkColumns& columns) noexcept {
  add_to_ids<Id>(columns.tets, part.first_vertex);
  add_to_ids<Id>(columns.faces, part.first_vertex);
  add_to_ids<Id>(columns.face_tets, part.first_tet);
  add_to_ids<std::uint16_t>(columns.face_labels, part.first_label);
}

/// Stores places that are doubles, moved, as whatever number the mesh has.
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

/// Places of a chunk before they are moved.
struct PlacesToMove {
  std::vector<std::byte> bytes;
};

using Parts = std::vector<JoinedPart>;

ThinWalls thin_walls_of(const Parts& parts) {
  ThinWalls all;
  for (const JoinedPart& part : parts) {
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

std::optional<BoundaryTopology> boundary_of(const Parts& parts) {
  BoundaryTopology all;
  for (const JoinedPart& part : parts) {
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

std::optional<Improvement> improvement_of(const Parts& parts) {
  Improvement all;
  for (const JoinedPart& part : parts) {
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

/// Enters one more grid's mesh behind the others.
void add_to_header(const std::string& name, const MeshHeader& of, MeshHeader& header) {
  if (header.parts.empty()) {
    header = of;
    header.vertex_count = header.tet_count = header.face_count = header.chunk_count = 0;
  }
  header.parts.push_back({name, header.vertex_count, of.vertex_count, header.tet_count,
                          of.tet_count, of.spacing, of.levels});
  header.vertex_count += of.vertex_count;
  header.tet_count += of.tet_count;
  header.face_count += of.face_count;
  header.chunk_count += of.chunk_count;
  header.bounds = box_around(header.bounds, of.bounds);
  if (header.box && of.box) header.box = box_around(*header.box, *of.box);
  header.spacing = std::min(header.spacing, of.spacing);
  header.levels = std::max(header.levels, of.levels);
  if (header.parts.size() > 1 && !of.inside_guess.empty()) {
    absl::StrAppend(&header.inside_guess, header.inside_guess.empty() ? "" : "\n",
                    of.inside_guess);
  }
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

JoinedPlan::JoinedPlan(MeshFacts facts, std::vector<JoinedPart> parts)
    : MeshPlan(std::move(facts)), parts_(std::move(parts)) {}

const JoinedPart& JoinedPlan::part_of(std::uint64_t chunk) const noexcept {
  const auto after = std::ranges::upper_bound(parts_, chunk, {}, &JoinedPart::first_chunk);
  return *(after - 1);
}

ChunkExtent JoinedPlan::chunk(std::uint64_t index) const noexcept {
  const JoinedPart& part = part_of(index);
  ChunkExtent chunk = part.plan->chunk(index - part.first_chunk);
  chunk.first_vertex += part.first_vertex;
  chunk.first_tet += part.first_tet;
  chunk.first_face += part.first_face;
  return chunk;
}

QualityStats JoinedPlan::fill_chunk(std::uint64_t index,
                                    MeshWorkspace& workspace,
                                    ChunkColumns columns) const noexcept {
  const CoordinateType stored = header().coordinate_type;
  const JoinedPart& part = part_of(index);
  ChunkColumns own = columns;
  if (part.move) {
    std::vector<std::byte>& places = workspace.get<PlacesToMove>().bytes;
    places.resize(columns.positions.size() / size_of(stored) * sizeof(double));
    own.positions = places;
  }
  const QualityStats stats = part.plan->fill_chunk(index - part.first_chunk, workspace, own);
  if (workspace.get<FillWatch>().stops()) return {};
  if (part.move && stored == CoordinateType::kFloat64) {
    store_moved<double>(own.positions, *part.move, columns.positions);
  } else if (part.move) {
    store_moved<float>(own.positions, *part.move, columns.positions);
  }
  if (header().index_type == IndexType::kUint64) {
    number_on<std::uint64_t>(part, columns);
  } else {
    number_on<std::uint32_t>(part, columns);
  }
  return stats;
}

std::uint64_t JoinedPlan::bytes() const noexcept {
  std::uint64_t bytes = 0;
  for (const JoinedPart& part : parts_) bytes += part.plan->bytes();
  return bytes;
}

absl::StatusOr<std::shared_ptr<const MeshPlan>> plan_joined(const PlanJob& job,
                                                            const PlanOne& plan_one,
                                                            const Cancellation& cancellation) {
  const std::vector<std::string> names = names_of(*grids_of(job.shape));
  absl::Status status = check_grid_names(names);
  if (status.ok()) {
    status = check_features(features_of(job.request) | features_of(job.shape),
                            field_names(job.request));
  }
  if (!status.ok()) return status;
  PartPlanner planner(job, plan_one, cancellation);
  auto plans = planner.plan_all();
  if (!plans.ok()) return plans.status();

  MeshFacts facts{.shape = job.shape, .statistics = statistics_of(job.request)};
  MeshHeader& header = facts.header;
  const WorldPoint to = plans->front()->header().origin;
  Parts parts;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const MeshHeader& of = (*plans)[i]->header();
    JoinedPart& part = parts.emplace_back();
    part = {(*plans)[i],
            {},
            header.chunk_count,
            header.vertex_count,
            header.tet_count,
            header.face_count,
            i * of.face_labels.size()};
    if (planner.is_moved(i)) {
      part.move = {of.origin.x - to.x, of.origin.y - to.y, of.origin.z - to.z};
    }
    add_to_header(names[i], of, header);
    facts.surface_bricks = std::max(facts.surface_bricks, (*plans)[i]->surface_bricks());
  }
  header.face_labels = labels_of_parts(header.face_labels, header.parts);
  if (status = check_part_labels(header); !status.ok()) return status;
  facts.thin_walls = thin_walls_of(parts);
  facts.boundary = boundary_of(parts);
  facts.improvement = improvement_of(parts);
  return std::make_shared<const JoinedPlan>(std::move(facts), std::move(parts));
}

}  // namespace tet
