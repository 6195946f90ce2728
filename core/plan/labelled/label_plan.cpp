#include "core/plan/labelled/label_plan.h"

#include <limits>
#include <utility>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "core/base/check.h"
#include "core/base/heap_bytes.h"
#include "core/mesh/improve/improve_labels.h"
#include "core/plan/budget.h"
#include "core/plan/fill_watch.h"
#include "core/plan/labelled/fill_labelled_brick.h"
#include "core/plan/labelled/label_sizes.h"
#include "core/plan/mesh_place.h"
#include "core/plan/mesh_workspace.h"
#include "core/plan/sample_fields.h"

namespace tet {
namespace {

LabelRules label_rules_of(const LabelJob& job) {
  return {stuffing_rules(Preset::kBothSides).limits, job.domain, job.kept};
}

absl::StatusOr<Octree> grow_label_tree(const LabelSurvey& survey,
                                       const LabelJob& job,
                                       const Cancellation& cancellation) {
  const OctreeCover cover{{job.domain}, job.domain};
  LeafRules rules;
  rules.max_levels = job.request.levels;
  auto refined = cells_above_sizes(survey, job.largest_leaf, job.lattice.voxel_size,
                                   job.request, job.limits, cancellation);
  if (!refined.ok()) return refined.status();
  rules.refined = *std::move(refined);
  return build_octree(survey.finest(), {}, nullptr, cover, rules, cancellation);
}

MeshHeader header_of_labels(const CountedLabels& mesh, const LabelJob& job) {
  MeshHeader header;
  header.vertex_count = mesh.first_vertex(mesh.brick_count());
  header.tet_count = mesh.first_tet(mesh.brick_count());
  header.levels = static_cast<int>(mesh.tree().levels.size()) - 1;
  header.labels = job.labels;
  header.inside_guess = job.inside_guess;
  header.fields = arrays_of(job.request.fields);
  if (job.request.box) header.box = world_box_of(job.domain, job.lattice);
  const bool wide = header.vertex_count > std::numeric_limits<std::uint32_t>::max();
  header.index_type =
      wide ? IndexType::kUint64 : job.request.indices.value_or(IndexType::kUint32);
  return header;
}

/// Every brick of the domain has an entry, whatever is in it.
absl::Status check_label_bricks(const BrickBox& domain, const MeshLimits& limits) {
  constexpr double kBytesPerEntry = sizeof(BrickState) + sizeof(void*);
  double bytes = kBytesPerEntry;
  for (const auto& [min, max] :
       {std::pair(domain.min.x, domain.max.x), std::pair(domain.min.y, domain.max.y),
        std::pair(domain.min.z, domain.max.z)}) {
    bytes *= max - min + 2.0;
  }
  if (bytes <= static_cast<double>(limits.max_plan_bytes)) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrFormat(
      "the bricks of 8^3 cells of the box would take %.3g bytes while the mesh is counted; the "
      "limit is %d. Use a larger spacing or a smaller box",
      bytes, limits.max_plan_bytes));
}

absl::Status check_label_tets(const MeshHeader& header, const MeshLimits& limits) {
  if (header.tet_count == 0) {
    return absl::FailedPreconditionError(
        "there is nothing to mesh: no label but the background is left in the box. Name other "
        "labels, another background, or a smaller spacing");
  }
  if (header.tet_count <= limits.max_tets) return absl::OkStatus();
  return absl::ResourceExhaustedError(
      absl::StrFormat("the mesh would have %d tets; the limit is %d. Use more levels, a larger "
                      "spacing or a smaller box",
                      header.tet_count, limits.max_tets));
}

std::vector<std::size_t> cut_labels_into_chunks(const CountedLabels& mesh,
                                                std::size_t chunk_bytes,
                                                MeshHeader& header) {
  const auto bytes_before = [&](std::size_t brick) {
    return ChunkSizes(header, mesh.first_vertex(brick), mesh.first_tet(brick)).total();
  };
  std::vector<std::size_t> first_brick{0};
  for (std::size_t brick = 0; brick < mesh.brick_count(); ++brick) {
    const bool fits = bytes_before(brick + 1) - bytes_before(first_brick.back()) <= chunk_bytes;
    if (!fits && brick > first_brick.back()) first_brick.push_back(brick);
  }
  first_brick.push_back(mesh.brick_count());
  header.chunk_count = first_brick.size() - 1;
  return first_brick;
}

}  // namespace

LabelPlan::LabelPlan(MeshFacts facts,
                     LabelledSource source,
                     CountedLabels mesh,
                     std::vector<std::size_t> first_brick)
    : MovablePlan(std::move(facts)),
      source_(std::move(source)),
      mesh_(std::move(mesh)),
      first_brick_(std::move(first_brick)) {}

ChunkExtent LabelPlan::bricks(std::size_t begin, std::size_t end) const noexcept {
  return {mesh_.first_vertex(begin), mesh_.first_vertex(end) - mesh_.first_vertex(begin),
          mesh_.first_tet(begin), mesh_.first_tet(end) - mesh_.first_tet(begin)};
}

ChunkExtent LabelPlan::chunk(std::uint64_t index) const noexcept {
  return bricks(first_brick_[index], first_brick_[index + 1]);
}

QualityStats LabelPlan::fill_chunk(std::uint64_t index,
                                   MeshWorkspace& workspace,
                                   ChunkColumns columns) const noexcept {
  const ChunkColumns all = columns;
  LabelledBrickFiller filler(mesh_, header(), source_.to_world, statistics(),
                             workspace.get<LabelledScratch>());
  const FillWatch& watch = workspace.get<FillWatch>();
  for (std::size_t brick = first_brick_[index]; brick < first_brick_[index + 1]; ++brick) {
    if (watch.stops()) return {};
    const ChunkExtent extent = bricks(brick, brick + 1);
    const ChunkSizes size(header(), extent.vertex_count, extent.tet_count);
    filler.fill(brick, {columns.positions.first(size.positions), columns.tets.first(size.tets),
                        columns.regions.first(size.regions)});
    columns = {columns.positions.subspan(size.positions), columns.tets.subspan(size.tets),
               columns.regions.subspan(size.regions)};
  }
  TET_CHECK(columns.positions.empty() && columns.tets.empty() && columns.regions.empty());
  if (!all.fields.empty()) fill_fields(chunk(index), all);
  return filler.stats();
}

void LabelPlan::fill_fields(const ChunkExtent&, const ChunkColumns& columns) const noexcept {
  sample_fields(source_.fields, header(), columns.positions, columns.fields);
}

Improvement LabelPlan::improve(TetMesh& mesh, const Cancellation& cancellation) const {
  const auto [min, max] = corner_box(mesh_.rules().domain);
  const auto point = [](const VoxelCoord& corner) {
    return WorldPoint{1.0 * corner.x, 1.0 * corner.y, 1.0 * corner.z};
  };
  const LabelledSpace space{.source = *source_.labels,
                            .to_world = source_.to_world,
                            .domain = {point(min), point(max)},
                            .kept = mesh_.rules().kept};
  return improve_labels(mesh, space, mesh_.vertices_between_labels(), cancellation);
}

std::uint64_t LabelPlan::bytes() const noexcept {
  return mesh_.bytes() + heap_bytes(first_brick_);
}

absl::StatusOr<std::shared_ptr<const LabelPlan>> plan_labels(const LabelJob& job,
                                                             const Cancellation& cancellation) {
  if (auto status = check_domain_budget(job.domain, job.request.levels, job.limits);
      !status.ok()) {
    return status;
  }
  if (auto s = check_label_bricks(job.domain, job.limits); !s.ok()) return s;
  absl::StatusOr<LabelSurvey> survey = survey_labels(
      *job.source, label_rules_of(job), job.limits.max_plan_bytes, cancellation, job.progress);
  if (!survey.ok()) return survey.status();
  absl::StatusOr<Octree> tree = grow_label_tree(*survey, job, cancellation);
  if (!tree.ok()) return tree.status();
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  CountedLabels mesh(*std::move(survey), *std::move(tree), cancellation);
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  MeshHeader header = header_of_labels(mesh, job);
  if (auto status = check_label_tets(header, job.limits); !status.ok()) return status;
  // Moved nodes may lie beyond the domain where labels meet at its faces, by half a spacing.
  const auto to_world =
      place_lattice(job.lattice, corner_box(job.domain), 0.5, job.request, header);
  if (!to_world.ok()) return to_world.status();
  std::vector<std::size_t> first_brick =
      cut_labels_into_chunks(mesh, job.limits.chunk_bytes, header);
  return std::make_shared<const LabelPlan>(
      MeshFacts{.shape = job.shape,
                .header = std::move(header),
                .statistics = statistics_before_moves(job.request)},
      LabelledSource{job.source, *to_world, job.request.fields}, std::move(mesh),
      std::move(first_brick));
}

}  // namespace tet
