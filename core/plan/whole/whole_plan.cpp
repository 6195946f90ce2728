#include "core/plan/whole/whole_plan.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "core/base/heap_bytes.h"
#include "core/graded/stuffed_background.h"
#include "core/mesh/boundary.h"
#include "core/mesh/face_labeller.h"
#include "core/mesh/find_faces.h"
#include "core/mesh/quality.h"
#include "core/plan/check_tets.h"
#include "core/plan/mesh_place.h"

namespace tet {
namespace {

absl::Status check_tree(const GradedTree& graded, const MeshLimits& limits) {
  const std::uint64_t bytes = background_bytes(graded.node_count, graded.tet_count);
  if (bytes <= limits.max_plan_bytes &&
      graded.node_count < std::numeric_limits<NodeId>::max()) {
    return absl::OkStatus();
  }
  return absl::ResourceExhaustedError(
      absl::StrFormat("grading the surface takes %d nodes and %d tets of background, about %d "
                      "bytes; the limit is "
                      "%d. Use larger sizes or smaller regions",
                      graded.node_count, graded.tet_count, bytes, limits.max_plan_bytes));
}

/// Whether there is room for the mesh beside what it is made from.
absl::Status check_bytes(const MeshHeader& header,
                         std::uint64_t background,
                         const MeshLimits& limits) {
  if (header.tet_count > limits.max_tets) {
    return absl::ResourceExhaustedError(
        absl::StrFormat("the mesh would have %d tets; the limit is %d. Use larger sizes",
                        header.tet_count, limits.max_tets));
  }
  const std::uint64_t bytes = background + ChunkSizes(header, whole_of(header)).total();
  if (bytes <= limits.max_plan_bytes) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrFormat(
      "%d vertices and %d tets with a graded surface would take %d bytes; the limit is %d. Use "
      "larger sizes",
      header.vertex_count, header.tet_count, bytes, limits.max_plan_bytes));
}

MeshHeader header_of_whole(const StuffedBackground& stuffed, const MeshRequest& request) {
  MeshHeader header;
  header.vertex_count = stuffed.vertex_count();
  header.tet_count = stuffed.tet_count();
  header.levels = stuffed.levels();
  header.fields = arrays_of(request);
  set_face_labels(request, has_cut(request), header);
  header.index_type = index_type_of(header, request);
  return header;
}

/// Says how many chunks there are, when all else is counted.
void count_chunks(std::size_t chunk_bytes, MeshHeader& header) {
  const std::size_t bytes = ChunkSizes(header, whole_of(header)).total();
  header.chunk_count = std::max<std::size_t>(1, (bytes + chunk_bytes - 1) / chunk_bytes);
}

/// Finds the faces of a whole mesh, which has the labels.
void find_faces_of(const Scene* scene, const Cancellation& cancellation, WholeMesh& whole) {
  const std::vector<CutFaces>& faces = whole.vertex_faces;
  FoundFaces found{
      find_boundary_faces(whole.mesh, cancellation), whole.mesh.header.face_labels,
      [&](const TetFace&, const Triangle& triangle) {
        const unsigned shared =
            faces.empty() ? 0U : faces[triangle[0]] & faces[triangle[1]] & faces[triangle[2]];
        return label_of_cut(shared);
      }};
  set_faces(found, whole.mesh, whole.mesh);
  label_regions(whole.mesh, scene, cancellation);
}

/// Where part `index` of `parts` begins.
std::uint64_t begin_of(std::uint64_t index, std::uint64_t parts, std::uint64_t all) noexcept {
  return all / parts * index + all % parts * index / parts;
}

void copy_from(std::span<const std::byte> column,
               std::size_t first,
               std::span<std::byte> to) noexcept {
  std::ranges::copy(column.subspan(first, to.size()), to.begin());
}

/// The first face of a mesh that belongs to a tet from `tet` on.
std::uint64_t first_face_of(const TetMesh& mesh, std::uint64_t tet) noexcept {
  std::uint64_t begin = 0, end = mesh.header.face_count;
  while (begin < end) {
    const std::uint64_t middle = begin + (end - begin) / 2;
    if (mesh.face_tet(middle) < tet) {
      begin = middle + 1;
    } else {
      end = middle;
    }
  }
  return begin;
}

/// The tree whose leaves carry the background.
GradedTree grow_tree(const PreparedMesh& prepared,
                     const Sizing& sizing,
                     LeafRules rules,
                     const Cancellation& cancellation) {
  rules.layers = std::max(rules.layers, kGradedLayers);
  GradedCover cover{prepared.bricks, prepared.space.domain};
  cover.finest_at_surface = !sizing.grade_surface;
  if (cover.finest_at_surface || !rules.shells.empty()) {
    cover.at_surface =
        cells_at_surface(prepared.field, prepared.bricks.near_surface, cancellation);
  }
  return grow_graded_tree(cover, rules, cancellation);
}

}  // namespace

std::uint64_t WholeMesh::bytes() const noexcept {
  return mesh.positions.size() + mesh.tets.size() + mesh.faces.size() + mesh.face_tets.size() +
         mesh.face_labels.size() + all_heap_bytes(vertex_levels, vertex_faces);
}

WholePlan::WholePlan(MeshFacts facts, MeshSource source, WholeMesh whole)
    : LatticePlan(std::move(facts), std::move(source)), whole_(std::move(whole)) {}

ChunkExtent WholePlan::chunk(std::uint64_t index) const noexcept {
  const auto part = [&](std::uint64_t all) {
    const std::uint64_t begin = begin_of(index, header().chunk_count, all);
    return std::pair(begin, begin_of(index + 1, header().chunk_count, all) - begin);
  };
  const auto [first_vertex, vertices] = part(header().vertex_count);
  const auto [first_tet, tets] = part(header().tet_count);
  const std::uint64_t first_face = first_face_of(whole_.mesh, first_tet);
  return {first_vertex, vertices,   first_tet,
          tets,         first_face, first_face_of(whole_.mesh, first_tet + tets) - first_face};
}

QualityStats WholePlan::fill_chunk(std::uint64_t index,
                                   MeshWorkspace& /*workspace*/,
                                   ChunkColumns columns) const noexcept {
  const ChunkExtent extent = chunk(index);
  const ChunkSizes before = ChunkSizes::before(header(), extent);
  const TetMesh& mesh = whole_.mesh;
  MeshView view = mesh.view();
  view.tets = view.tets.subspan(before.tets, columns.tets.size());
  copy_from(view.positions, before.positions, columns.positions);
  std::ranges::copy(view.tets, columns.tets.begin());
  copy_from(mesh.faces.bytes(), before.faces, columns.faces);
  copy_from(mesh.face_tets.bytes(), before.face_tets, columns.face_tets);
  copy_from(mesh.face_labels.bytes(), before.face_labels, columns.face_labels);
  if (!columns.fields.empty()) fill_fields(extent, columns);
  if (statistics() == Statistics::kSkipped) return {};
  return measure_tets(view, header().spacing);
}

KnownOfVertices WholePlan::known_of_vertices() const noexcept {
  return {whole_.vertex_levels, whole_.vertex_faces};
}

absl::StatusOr<std::shared_ptr<const LatticePlan>> plan_whole(
    const PlanJob& job,
    const PreparedMesh& prepared,
    LeafRules rules,
    const Cancellation& cancellation) {
  const PhiField& field = prepared.field;
  GradedTree tree = grow_tree(prepared, job.request.sizing, std::move(rules), cancellation);
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  if (auto status = check_tree(tree, job.limits); !status.ok()) return status;
  const BackgroundMesh background = make_background(tree, field, cancellation);
  tree = {};
  SurfaceEdges edges = find_surface_edges(background, cancellation);
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  find_zeros(background, field, cancellation, edges);
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  const StuffedBackground stuffed(background, edges, kGradedLimits, cancellation);
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;

  MeshHeader header = header_of_whole(stuffed, job.request);
  if (auto status = check_not_empty(header, prepared, {}); !status.ok()) return status;
  if (prepared.space.domain) header.box = world_box_of(*prepared.space.domain, field);
  // Rounding takes a vertex no farther from the box around all than half a spacing.
  const absl::StatusOr<LatticeToWorld> to_world =
      place_in_world(field, stuffed.corner_box(), 0.5, job.request, header);
  if (!to_world.ok()) return to_world.status();
  const std::uint64_t used = background_bytes(background.node.size(), background.tet_count());
  if (auto status = check_bytes(header, used, job.limits); !status.ok()) return status;
  MeshHeader without_fields = header;
  without_fields.fields.clear();
  WholeMesh whole{TetMesh(without_fields)};
  stuffed.fill(*to_world, cancellation, whole.mesh);
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  whole.vertex_levels = stuffed.vertex_levels();
  if (background.box) whole.vertex_faces = stuffed.vertex_faces();
  if (header.has_faces()) {
    find_faces_of(field.scene, cancellation, whole);
    if (auto status = check_cancelled(cancellation); !status.ok()) return status;
    header.face_count = whole.mesh.header.face_count;
    if (auto status = check_bytes(header, used, job.limits); !status.ok()) return status;
  }
  count_chunks(job.limits.chunk_bytes, header);
  MeshFacts facts{.shape = job.shape,
                  .header = std::move(header),
                  .statistics = statistics_before_moves(job.request),
                  .surface_bricks = prepared.bricks.near_surface.size()};
  if (!job.request.skip_statistics) facts.boundary = measure_boundary(whole.mesh);
  return std::make_shared<const WholePlan>(
      std::move(facts), MeshSource{field, *to_world, job.request.fields, prepared.stand_in},
      std::move(whole));
}

}  // namespace tet
