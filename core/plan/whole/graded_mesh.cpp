#include "core/plan/whole/graded_mesh.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "core/base/heap_bytes.h"
#include "core/graded/stuffed_background.h"
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

/// The mesh beside what it is made from.
absl::Status check_mesh(const MeshHeader& header,
                        std::uint64_t background,
                        const MeshLimits& limits) {
  if (header.tet_count > limits.max_tets) {
    return absl::ResourceExhaustedError(
        absl::StrFormat("the mesh would have %d tets; the limit is %d. Use larger sizes",
                        header.tet_count, limits.max_tets));
  }
  const std::uint64_t bytes =
      background + ChunkSizes(header, header.vertex_count, header.tet_count).total();
  if (bytes <= limits.max_plan_bytes) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrFormat(
      "%d vertices and %d tets with a graded surface would take %d bytes; the limit is %d. Use "
      "larger sizes",
      header.vertex_count, header.tet_count, bytes, limits.max_plan_bytes));
}

MeshHeader header_of(const StuffedBackground& stuffed,
                     const MeshRequest& request,
                     std::size_t chunk_bytes) {
  MeshHeader header;
  header.vertex_count = stuffed.vertex_count();
  header.tet_count = stuffed.tet_count();
  header.levels = stuffed.levels();
  header.index_type = request.indices.value_or(IndexType::kUint32);
  header.fields = arrays_of(request);
  const std::size_t bytes = ChunkSizes(header, header.vertex_count, header.tet_count).total();
  header.chunk_count = std::max<std::size_t>(1, (bytes + chunk_bytes - 1) / chunk_bytes);
  return header;
}

/// Where part `index` of `parts` begins.
std::uint64_t begin_of(std::uint64_t index, std::uint64_t parts, std::uint64_t all) noexcept {
  return all / parts * index + all % parts * index / parts;
}

}  // namespace

ChunkExtent GradedMesh::chunk(std::uint64_t index) const noexcept {
  const MeshHeader& header = mesh.header;
  const auto part = [&](std::uint64_t all) {
    const std::uint64_t begin = begin_of(index, header.chunk_count, all);
    return std::pair(begin, begin_of(index + 1, header.chunk_count, all) - begin);
  };
  const auto [first_vertex, vertices] = part(header.vertex_count);
  const auto [first_tet, tets] = part(header.tet_count);
  return {first_vertex, vertices, first_tet, tets};
}

void GradedMesh::fill_chunk(std::uint64_t index, ChunkColumns columns) const noexcept {
  const ChunkExtent extent = chunk(index);
  const ChunkSizes before(mesh.header, extent.first_vertex, extent.first_tet);
  std::ranges::copy(mesh.positions.bytes().subspan(before.positions, columns.positions.size()),
                    columns.positions.begin());
  std::ranges::copy(mesh.tets.bytes().subspan(before.tets, columns.tets.size()),
                    columns.tets.begin());
}

std::uint64_t GradedMesh::bytes() const noexcept {
  return mesh.positions.size() + mesh.tets.size() + all_heap_bytes(vertex_levels, vertex_faces);
}

absl::StatusOr<GradedMesh> make_graded_mesh(const PreparedMesh& prepared,
                                            const MeshRequest& request,
                                            LeafRules rules,
                                            const MeshLimits& limits,
                                            const Cancellation& cancellation) {
  const PhiField& field = prepared.field;
  rules.layers = std::max(rules.layers, kGradedLayers);
  GradedCover cover{prepared.bricks, prepared.space.domain};
  cover.finest_at_surface = !request.sizing.grade_surface;
  if (cover.finest_at_surface || !rules.shells.empty()) {
    cover.at_surface = cells_at_surface(field, prepared.bricks.near_surface, cancellation);
  }
  GradedTree tree = grow_graded_tree(cover, rules, cancellation);
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  if (auto status = check_tree(tree, limits); !status.ok()) return status;
  const BackgroundMesh background = make_background(tree, field, cancellation);
  tree = {};
  SurfaceEdges edges = find_surface_edges(background, cancellation);
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  find_zeros(background, field, cancellation, edges);
  const StuffedBackground stuffed(background, edges, kGradedLimits, cancellation);
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;

  GradedMesh graded;
  MeshHeader header = header_of(stuffed, request, limits.chunk_bytes);
  if (header.tet_count == 0) return graded;
  // Rounding takes a vertex no farther from the box around all than half a spacing.
  const absl::StatusOr<LatticeToWorld> to_world =
      place_in_world(field, stuffed.corner_box(), 0.5, request, header);
  if (!to_world.ok()) return to_world.status();
  graded.to_world = *to_world;
  const std::uint64_t used = background_bytes(background.node.size(), background.tet_count());
  if (auto status = check_mesh(header, used, limits); !status.ok()) return status;
  header.fields.clear();  // sampled chunk by chunk
  graded.mesh = TetMesh(header);
  stuffed.fill(graded.to_world, cancellation, graded.mesh);
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  graded.vertex_levels = stuffed.vertex_levels();
  if (background.box) graded.vertex_faces = stuffed.vertex_faces();
  if (!request.skip_statistics) graded.boundary = measure_boundary(graded.mesh);
  return graded;
}

}  // namespace tet
