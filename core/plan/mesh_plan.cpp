#include "core/plan/mesh_plan.h"

#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "core/base/check.h"
#include "core/base/parallel.h"
#include "core/plan/brick/boundary_count.h"
#include "core/plan/brick/counted_mesh.h"
#include "core/plan/brick/divided_survey.h"
#include "core/plan/brick/fill_brick.h"
#include "core/plan/brick/survey.h"
#include "core/plan/budget.h"
#include "core/plan/fill_mesh.h"
#include "core/plan/joined/joined_plan.h"
#include "core/plan/mesh_place.h"
#include "core/plan/prepared_mesh.h"
#include "core/plan/sample_fields.h"
#include "core/plan/whole/graded_mesh.h"
#include "core/transfer/compact_chunk.h"

namespace tet {
namespace {

/// Why there is no mesh, though what is meshed and the request are fine.
absl::Status nothing_to_mesh(const PreparedMesh& prepared, const ThinWalls& thin) {
  const CanonicalRequest& asked = prepared.asked;
  if (stuffing_rules(asked.preset).both_sides) {
    return absl::FailedPreconditionError(absl::StrFormat(
        "the surface at iso %g does not reach into the box, so there is nothing to mesh",
        asked.iso));
  }
  if (!thin.any()) {
    return absl::FailedPreconditionError(
        absl::StrFormat("nothing%s is inside at iso %g, so there is nothing to mesh",
                        prepared.space.domain ? " in the box" : "", asked.iso));
  }
  return absl::FailedPreconditionError(absl::StrFormat(
      "all that is inside at iso %g is thinner than spacing %g resolves, so nothing of it is "
      "left to mesh; a grid sampled and meshed at about %.3g would resolve it",
      asked.iso, asked.spacing, thin.suggested_spacing));
}

/// Improves the mesh, which is whole for as long as that takes.
absl::StatusOr<std::shared_ptr<const MeshPlan>> improve_plan(const MeshPlan& plan,
                                                             const MeshLimits& limits,
                                                             const Cancellation& cancellation) {
  if (auto status = check_improvement_budget(plan.header(), limits); !status.ok()) {
    return status;
  }
  absl::StatusOr<FilledMesh> filled =
      fill_mesh(plan, cancellation, nullptr, {}, FieldValues::kLater);
  if (!filled.ok()) return filled.status();
  const Improvement improvement = plan.improve(filled->mesh, cancellation);
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  return plan.with_positions(std::move(filled->mesh.positions), improvement);
}

}  // namespace

struct MeshPlan::Impl {
  Shape shape;
  PhiField field;
  CountedMesh mesh;
  MeshHeader header;
  std::optional<BoundaryTopology> boundary;
  LatticeToWorld to_world;
  ThinWalls thin_walls;
  std::vector<std::size_t> first_brick = {};  // of each chunk, and one more
  std::optional<GradedMesh> graded = {};      // made already; then there are no bricks
  std::vector<VertexField> fields = {};
  std::optional<JoinedPlan> joined = {};  // of several grids; then all chunks are its
  Statistics statistics = Statistics::kMeasured;

  /// Of what has no bricks.
  static MeshPlan::Impl without_bricks(Shape shape, const MeshHeader& header);

  void cut_into_chunks(std::size_t chunk_bytes);
  void fill_fields(const ChunkExtent& extent, const ChunkColumns& columns) const noexcept;
};

MeshPlan::Impl MeshPlan::Impl::without_bricks(Shape shape, const MeshHeader& header) {
  MeshStructure none;
  none.tree.levels.emplace_back();
  return {std::move(shape), {}, CountedMesh(std::move(none), {}), header, {}, {}, {}};
}

void MeshPlan::Impl::cut_into_chunks(std::size_t chunk_bytes) {
  const auto bytes_before = [&](std::size_t brick) {
    return ChunkSizes(header, mesh.first_vertex(brick), mesh.first_tet(brick)).total();
  };
  first_brick.push_back(0);
  for (std::size_t brick = 0; brick < mesh.brick_count(); ++brick) {
    const bool fits = bytes_before(brick + 1) - bytes_before(first_brick.back()) <= chunk_bytes;
    if (!fits && brick > first_brick.back()) first_brick.push_back(brick);
  }
  first_brick.push_back(mesh.brick_count());
  header.chunk_count = first_brick.size() - 1;
}

MeshPlan::MeshPlan(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {
  if (impl_->joined) improvement_ = impl_->joined->improvement();
}
MeshPlan::~MeshPlan() = default;

const MeshHeader& MeshPlan::header() const noexcept { return impl_->header; }

const ThinWalls& MeshPlan::thin_walls() const noexcept { return impl_->thin_walls; }

Statistics MeshPlan::statistics() const noexcept { return impl_->statistics; }

const std::optional<BoundaryTopology>& MeshPlan::boundary() const noexcept {
  return impl_->boundary;
}

bool MeshPlan::has_bricks() const noexcept { return !impl_->graded && !impl_->joined; }

ChunkExtent MeshPlan::chunk(std::uint64_t index) const noexcept {
  if (impl_->joined) return impl_->joined->chunk(index);
  if (impl_->graded) return impl_->graded->chunk(index);
  return bricks(bricks_of_chunk(index));
}

BrickRange MeshPlan::bricks_of_chunk(std::uint64_t index) const noexcept {
  return {impl_->first_brick[index], impl_->first_brick[index + 1]};
}

std::uint64_t MeshPlan::bytes() const noexcept {
  if (impl_->joined) return impl_->joined->bytes();
  const std::uint64_t made = impl_->graded ? impl_->graded->bytes() : 0;
  return impl_->mesh.bytes() + heap_bytes(impl_->first_brick) + made + positions_.size();
}

ComparedMesh MeshPlan::counted() const noexcept { return {impl_->mesh, impl_->field}; }

ChunkExtent MeshPlan::bricks(const BrickRange& range) const noexcept {
  const auto [begin, end] = range;
  const CountedMesh& mesh = impl_->mesh;
  return {mesh.first_vertex(begin), mesh.first_vertex(end) - mesh.first_vertex(begin),
          mesh.first_tet(begin), mesh.first_tet(end) - mesh.first_tet(begin)};
}

QualityStats MeshPlan::fill_chunk(std::uint64_t index,
                                  MeshWorkspace& workspace,
                                  ChunkColumns columns) const noexcept {
  if (impl_->joined) return impl_->joined->fill_chunk(index, workspace, columns);
  QualityStats stats;
  if (impl_->graded) {
    impl_->graded->fill_chunk(index, columns);
  } else {
    stats = fill_bricks(bricks_of_chunk(index), workspace, columns);
  }
  if (impl_->graded || improvement_) {
    const std::span<const std::byte> positions =
        improvement_ ? positions_.bytes() : impl_->graded->mesh.positions.bytes();
    const std::size_t first = ChunkSizes(header(), chunk(index).first_vertex, 0).positions;
    std::memcpy(columns.positions.data(), positions.data() + first, columns.positions.size());
    if (impl_->statistics == Statistics::kMeasured) {
      stats = measure_tets(
          {header().coordinate_type, header().index_type, positions, columns.tets});
    }
  }
  if (!columns.fields.empty()) impl_->fill_fields(chunk(index), columns);
  return stats;
}

/// Values of vertices that have their final places, which are in `columns` too.
void MeshPlan::Impl::fill_fields(const ChunkExtent& extent,
                                 const ChunkColumns& columns) const noexcept {
  if (!fields.empty()) sample_fields(fields, header, columns.positions, columns.fields);
  if (!graded || graded->vertex_faces.empty()) return;
  const std::span<const CutFaces> faces = graded->vertex_faces;
  write_cut_faces(faces.subspan(extent.first_vertex, extent.vertex_count), header,
                  columns.fields);
}

void MeshPlan::add_fields(TetMesh& mesh) const {
  mesh.header.fields = header().fields;
  if (mesh.header.fields.empty()) return;
  constexpr std::size_t kVerticesPerRange = 4096;
  const std::uint64_t vertices = mesh.header.vertex_count;
  mesh.fields = ByteBuffer(ChunkSizes(mesh.header, vertices, 0).fields);
  for_each_range(vertices, kVerticesPerRange, [&](std::size_t begin, std::size_t end) {
    const ChunkExtent extent{begin, end - begin, 0, 0};
    impl_->fill_fields(extent, mesh.columns_of(extent));
  });
}

QualityStats MeshPlan::fill_bricks(const BrickRange& range,
                                   MeshWorkspace& workspace,
                                   ChunkColumns columns) const noexcept {
  const CountedMesh& mesh = impl_->mesh;
  BrickFiller filler(mesh, impl_->field, header(), impl_->to_world, impl_->statistics,
                     workspace.impl());
  for (std::size_t brick = range.begin; brick < range.end; ++brick) {
    const ChunkSizes size(header(), mesh.first_vertex(brick + 1) - mesh.first_vertex(brick),
                          mesh.first_tet(brick + 1) - mesh.first_tet(brick));
    filler.fill(brick, {columns.positions.first(size.positions), columns.tets.first(size.tets),
                        columns.regions.first(size.regions)});
    columns = {columns.positions.subspan(size.positions), columns.tets.subspan(size.tets),
               columns.regions.subspan(size.regions)};
  }
  TET_CHECK(columns.positions.empty() && columns.tets.empty() && columns.regions.empty());
  return filler.stats();
}

void MeshPlan::encode_chunk(std::uint64_t index,
                            MeshWorkspace& workspace,
                            std::vector<std::byte>& bytes) const {
  TET_CHECK(!improvement_ && has_bricks());
  encode_bricks(impl_->mesh, impl_->field, impl_->first_brick[index],
                impl_->first_brick[index + 1], workspace.impl().stuffing, bytes);
}

CompactFrame MeshPlan::compact_frame() const noexcept {
  return {impl_->to_world, impl_->mesh.rules()};
}

Improvement MeshPlan::improve(TetMesh& mesh, const Cancellation& cancellation) const {
  KnownOfVertices known;
  if (impl_->graded) known = {impl_->graded->vertex_levels, impl_->graded->vertex_faces};
  return improve_mesh(mesh, impl_->field, impl_->to_world, known, cancellation);
}

std::shared_ptr<const MeshPlan> MeshPlan::with_positions(ByteBuffer positions,
                                                         const Improvement& improvement) const {
  const auto plan = std::make_shared<MeshPlan>(impl_);
  plan->positions_ = std::move(positions);
  plan->improvement_ = improvement;
  return plan;
}

namespace {

absl::Status check_tets(const MeshHeader& header,
                        const PreparedMesh& prepared,
                        const ThinWalls& thin,
                        const MeshLimits& limits) {
  if (header.tet_count == 0) return nothing_to_mesh(prepared, thin);
  if (header.tet_count <= limits.max_tets) return absl::OkStatus();
  return absl::ResourceExhaustedError(
      absl::StrFormat("the mesh would have %d tets; the limit is %d. Use a larger spacing",
                      header.tet_count, limits.max_tets));
}

/// Header of a counted mesh, but for its place in the world and its chunks.
MeshHeader header_of(const CountedMesh& mesh, const MeshRequest& request) {
  MeshHeader header;
  header.vertex_count = mesh.first_vertex(mesh.brick_count());
  header.tet_count = mesh.first_tet(mesh.brick_count());
  header.levels = static_cast<int>(mesh.tree().levels.size()) - 1;
  header.has_regions = mesh.rules().both_sides;
  header.fields = arrays_of(request);
  const bool wide = header.vertex_count > std::numeric_limits<std::uint32_t>::max();
  header.index_type = wide ? IndexType::kUint64 : request.indices.value_or(IndexType::kUint32);
  return header;
}

/// Of a mesh without bricks, as it was made.
absl::StatusOr<std::shared_ptr<const MeshPlan>> plan_graded(const Shape& shape,
                                                            const PreparedMesh& prepared,
                                                            const MeshRequest& request,
                                                            const LeafRules& rules,
                                                            const MeshLimits& limits,
                                                            const Cancellation& cancellation) {
  absl::StatusOr<GradedMesh> graded =
      make_graded_mesh(prepared, request, rules, limits, cancellation);
  if (!graded.ok()) return graded.status();
  MeshHeader header = graded->mesh.header;
  header.fields = arrays_of(request);
  if (auto status = check_tets(header, prepared, {}, limits); !status.ok()) return status;
  MeshStructure no_bricks;
  no_bricks.tree.levels.emplace_back();
  auto impl = std::make_unique<MeshPlan::Impl>(
      MeshPlan::Impl{shape,
                     prepared.field,
                     CountedMesh(std::move(no_bricks), prepared.space.rules),
                     header,
                     graded->boundary,
                     graded->to_world,
                     {},
                     {},
                     *std::move(graded),
                     request.fields});
  impl->statistics = statistics_of(request);
  const auto plan = std::make_shared<const MeshPlan>(std::move(impl));
  if (!request.improve) return plan;
  return improve_plan(*plan, limits, cancellation);
}

absl::StatusOr<std::shared_ptr<const MeshPlan>> plan_joined(const GridList& grids,
                                                            const MeshRequest& request,
                                                            const MeshLimits& limits,
                                                            const Cancellation& cancellation,
                                                            MeshProgress* progress) {
  absl::StatusOr<JoinedPlan> joined =
      JoinedPlan::of(grids, request, limits, cancellation, progress);
  if (!joined.ok()) return joined.status();
  auto impl =
      std::make_unique<MeshPlan::Impl>(MeshPlan::Impl::without_bricks(grids, joined->header()));
  impl->boundary = joined->boundary();
  impl->thin_walls = joined->thin_walls();
  impl->statistics = statistics_of(request);
  impl->joined = *std::move(joined);
  return std::make_shared<const MeshPlan>(std::move(impl));
}

/// An earlier mesh, where parts of it may be those of the new one: it has the same rules and
/// lattice, and no part was made with regard to others.
struct AlikeMesh {
  ComparedMesh mesh;
  std::unique_ptr<const FieldDifference> difference;
};

std::optional<AlikeMesh> find_alike(const MeshPlan* earlier, const PreparedMesh& prepared) {
  if (earlier == nullptr || !earlier->has_bricks()) return std::nullopt;
  const ComparedMesh before = earlier->counted();
  if (!(before.mesh.rules() == prepared.space.rules) ||
      !can_reuse(before.mesh.survey(), prepared.space)) {
    return std::nullopt;
  }
  auto difference = FieldDifference::between(before.field, prepared.field);
  if (difference == nullptr) return std::nullopt;
  return AlikeMesh{before, std::move(difference)};
}

/// Surveys what neither an earlier plan nor other hosts have surveyed.
absl::StatusOr<Survey> survey_rest(const PreparedMesh& prepared,
                                   const std::optional<AlikeMesh>& alike,
                                   const SurveyedBlocks& surveyed,
                                   const Cancellation& cancellation,
                                   MeshProgress* progress) {
  if (!alike) return join_survey(prepared, surveyed, cancellation, progress);
  const EarlierSurvey before{alike->mesh.mesh.survey(), *alike->difference};
  return survey_bricks(prepared.field, prepared.bricks.near_surface, prepared.space,
                       cancellation, progress, &before);
}

}  // namespace

absl::StatusOr<std::shared_ptr<const MeshPlan>> plan_mesh(Shape shape,
                                                          const MeshRequest& request,
                                                          const MeshLimits& limits,
                                                          const Cancellation& cancellation,
                                                          MeshProgress* progress,
                                                          const SurveyedBlocks& surveyed,
                                                          const MeshPlan* earlier) {
  if (const GridList* grids = grids_of(shape)) {
    return plan_joined(*grids, request, limits, cancellation, progress);
  }
  absl::StatusOr<PreparedMesh> prepared = prepare_mesh(shape, request, limits, cancellation);
  if (!prepared.ok()) return prepared.status();
  const auto& [asked, of_shape, space, bricks] = *prepared;
  const PhiField& field = of_shape;  // clang 14 lets no lambda refer to parts of a binding
  const OctreeCover cover{bricks.inside, space.domain};
  const absl::StatusOr<LeafRules> rules = leaf_rules_within(
      limits, request.sizing, field, bricks, cover, asked.levels, cancellation);
  if (!rules.ok()) return rules.status();
  if (is_made_whole(request)) {
    return plan_graded(shape, *prepared, request, *rules, limits, cancellation);
  }
  const std::optional<AlikeMesh> alike = find_alike(earlier, *prepared);
  absl::StatusOr<Survey> survey =
      survey_rest(*prepared, alike, surveyed, cancellation, progress);
  if (!survey.ok()) return survey.status();
  std::optional<BoundaryTopology> boundary;
  const bool is_flat_box = space.domain && !survey->box_cuts_surface;
  Octree tree;
  ThinWalls thin_walls;
  run_side_by_side(
      [&] {
        tree = build_octree({survey->bricks, survey->finest}, field, survey->inside_test(),
                            cover, *rules, cancellation);
      },
      [&] {
        if (survey->has_topology) boundary = count_boundary(*survey, cancellation);
      },
      [&] { thin_walls = gather_thin_walls(survey->thin, field.lattice_transform()); });
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  CountedMesh mesh(field, *std::move(survey), std::move(tree), space.rules, asked.levels == 0,
                   cancellation, alike ? &alike->mesh : nullptr);
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;

  const MeshHeader header = header_of(mesh, request);
  if (auto status = check_tets(header, *prepared, thin_walls, limits); !status.ok())
    return status;
  auto impl = std::make_unique<MeshPlan::Impl>(
      MeshPlan::Impl{std::move(shape), field, std::move(mesh), header, boundary, {}, {}});
  impl->thin_walls = std::move(thin_walls);
  impl->fields = request.fields;
  impl->statistics = statistics_of(request);
  // Moved nodes and cut points may lie beyond their brick, by less than half a spacing. The
  // faces of a domain that no surface cuts are flat.
  const absl::StatusOr<LatticeToWorld> to_world =
      place_in_world(field, space.domain ? corner_box(*space.domain) : corner_box(impl->mesh),
                     is_flat_box ? 0 : 0.5, request, impl->header);
  if (!to_world.ok()) return to_world.status();
  impl->to_world = *to_world;
  impl->cut_into_chunks(limits.chunk_bytes);
  const auto plan = std::make_shared<const MeshPlan>(std::move(impl));
  if (!request.improve) return plan;
  return improve_plan(*plan, limits, cancellation);
}

}  // namespace tet
