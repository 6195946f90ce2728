#include "core/plan/brick/plan_bricks.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "core/base/parallel.h"
#include "core/plan/brick/boundary_count.h"
#include "core/plan/brick/brick_plan.h"
#include "core/plan/brick/divided_survey.h"
#include "core/plan/brick/patched_tree.h"
#include "core/plan/check_tets.h"
#include "core/plan/leaf_budget.h"
#include "core/plan/mesh_place.h"

namespace tet {
namespace {

/// An earlier mesh, where parts of it may be those of the new one: it has the same rules and
/// lattice, and no part was made with regard to others.
struct AlikeMesh {
  ComparedMesh mesh;
  std::unique_ptr<const FieldDifference> difference;
};

std::optional<AlikeMesh> find_alike(const PlanJob& job, const PreparedMesh& prepared) {
  const BrickPlan* bricks = job.earlier == nullptr ? nullptr : bricks_beneath(*job.earlier);
  if (bricks == nullptr) return std::nullopt;
  const ComparedMesh before = bricks->counted();
  if (!(before.mesh.rules() == prepared.space.rules) ||
      !can_reuse(before.mesh.survey(), prepared.space)) {
    return std::nullopt;
  }
  auto difference = FieldDifference::between(before.field, prepared.field, job.replaced);
  if (difference == nullptr) return std::nullopt;
  return AlikeMesh{before, std::move(difference)};
}

/// Surveys what neither an earlier plan nor other hosts have surveyed.
absl::StatusOr<Survey> survey_rest(const PlanJob& job,
                                   const PreparedMesh& prepared,
                                   const std::optional<AlikeMesh>& alike,
                                   const Cancellation& cancellation) {
  if (!alike) return join_survey(prepared, job.surveyed, cancellation, job.progress);
  const EarlierSurvey before{alike->mesh.mesh.survey(), *alike->difference};
  return survey_bricks(prepared.field, prepared.bricks.near_surface, prepared.space,
                       cancellation, job.progress, &before);
}

/// An octree, and whether it has every brick that owns a corner.
struct GrownTree {
  Octree tree;
  bool complete = false;
};

GrownTree grow_tree(const Survey& survey,
                    const PreparedMesh& prepared,
                    const LeafRules& rules,
                    const std::optional<AlikeMesh>& alike,
                    const Cancellation& cancellation) {
  const InsideTest is_inside = survey.inside_test();
  const OctreeCover cover = cover_of(prepared);
  const OctreeSpace space{prepared.field, is_inside, cover, rules};
  if (alike && alike->difference->touched() != nullptr) {
    const FinestCells finest{survey.bricks, survey.finest};
    const EarlierTree earlier{alike->mesh.mesh.tree(), *alike->difference->touched()};
    if (can_patch(earlier, finest, space)) {
      return {patch_tree(finest, earlier, space, cancellation), true};
    }
  }
  return {build_octree({survey.bricks, survey.finest}, prepared.field, is_inside, cover, rules,
                       cancellation)};
}

/// All that follows from the survey alone.
struct Surveyed {
  GrownTree grown;
  ThinWalls thin_walls;
  std::optional<BoundaryTopology> boundary;
};

Surveyed follow_survey(const Survey& survey,
                       const PreparedMesh& prepared,
                       const LeafRules& rules,
                       const std::optional<AlikeMesh>& alike,
                       const Cancellation& cancellation) {
  Surveyed surveyed;
  run_side_by_side(
      [&] { surveyed.grown = grow_tree(survey, prepared, rules, alike, cancellation); },
      [&] {
        if (survey.has_topology) surveyed.boundary = count_boundary(survey, cancellation);
      },
      [&] {
        surveyed.thin_walls =
            gather_thin_walls(survey.thin, prepared.field.lattice_transform());
      });
  return surveyed;
}

/// Header of a counted mesh, but for its place in the world and its chunks.
MeshHeader header_of(const CountedMesh& mesh, const MeshRequest& request) {
  MeshHeader header;
  header.vertex_count = mesh.first_vertex(mesh.brick_count());
  header.tet_count = mesh.first_tet(mesh.brick_count());
  header.levels = static_cast<int>(mesh.tree().levels.size()) - 1;
  header.has_regions = mesh.rules().both_sides;
  header.fields = arrays_of(request);
  set_face_labels(request, header.has_regions, header);
  header.face_count = mesh.first_face(mesh.brick_count());
  header.index_type = index_type_of(header, request);
  return header;
}

/// Finest-level bricks that hold vertices, as a box of lattice corners.
VoxelBox corner_box_of(const CountedMesh& mesh) {
  VoxelBox box{{INT32_MAX, INT32_MAX, INT32_MAX}, {INT32_MIN, INT32_MIN, INT32_MIN}};
  const auto& bricks = mesh.tree().levels[0].bricks;
  for (std::size_t i = 0; i < bricks.size(); ++i) {
    if (mesh.first_vertex(i + 1) == mesh.first_vertex(i)) continue;
    const BrickCoord b = bricks[i];
    box.min = {std::min(box.min.x, 8 * b.x), std::min(box.min.y, 8 * b.y),
               std::min(box.min.z, 8 * b.z)};
    box.max = {std::max(box.max.x, 8 * b.x + 8), std::max(box.max.y, 8 * b.y + 8),
               std::max(box.max.z, 8 * b.z + 8)};
  }
  return box;
}

/// Where the mesh lies in the world; fills in the header's part of that.
absl::StatusOr<LatticeToWorld> place_mesh(const CountedMesh& mesh,
                                          const PreparedMesh& prepared,
                                          const MeshRequest& request,
                                          MeshHeader& header) {
  const std::optional<BrickBox>& domain = prepared.space.domain;
  // Moved nodes and cut points may lie beyond their brick, by less than half a spacing. The
  // faces of a domain that no surface cuts are flat.
  if (domain && request.box) header.box = world_box_of(*domain, prepared.field);
  const bool is_flat_box = domain && !mesh.survey().box_cuts_surface;
  return place_in_world(prepared.field, domain ? corner_box(*domain) : corner_box_of(mesh),
                        is_flat_box ? 0 : 0.5, request, header);
}

}  // namespace

absl::StatusOr<std::shared_ptr<const LatticePlan>> plan_bricks(
    const PlanJob& job,
    const PreparedMesh& prepared,
    const LeafRules& rules,
    const Cancellation& cancellation) {
  const std::optional<AlikeMesh> alike = find_alike(job, prepared);
  absl::StatusOr<Survey> survey = survey_rest(job, prepared, alike, cancellation);
  if (!survey.ok()) return survey.status();
  Surveyed surveyed = follow_survey(*survey, prepared, rules, alike, cancellation);
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  CountedMesh mesh({.field = prepared.field,
                    .survey = *std::move(survey),
                    .tree = std::move(surveyed.grown.tree),
                    .rules = prepared.space.rules,
                    .uniform = prepared.asked.levels == 0,
                    .faces = job.request.faces,
                    .complete = surveyed.grown.complete,
                    .earlier = alike ? &alike->mesh : nullptr},
                   cancellation);
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;

  // A box that the surface does not reach into lies on one side whole, and is meshed.
  if (mesh.rules().both_sides && mesh.survey().bricks.empty()) {
    auto status = check_any_surface(prepared.field, prepared.asked.iso);
    if (!status.ok()) return status;
  }
  MeshHeader header = header_of(mesh, job.request);
  if (auto status = check_tets(header, prepared, surveyed.thin_walls, job.limits);
      !status.ok()) {
    return status;
  }
  const auto to_world = place_mesh(mesh, prepared, job.request, header);
  if (!to_world.ok()) return to_world.status();
  std::vector<std::size_t> first_brick = cut_into_chunks(mesh, job.limits.chunk_bytes, header);
  return std::make_shared<const BrickPlan>(
      MeshFacts{.shape = job.shape,
                .header = std::move(header),
                .thin_walls = std::move(surveyed.thin_walls),
                .statistics = statistics_before_moves(job.request),
                .boundary = surveyed.boundary,
                .surface_bricks = prepared.bricks.near_surface.size()},
      MeshSource{prepared.field, *to_world, job.request.fields, prepared.stand_in},
      std::move(mesh), std::move(first_brick));
}

}  // namespace tet
