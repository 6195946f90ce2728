#include "core/second_order/second_order.h"

#include <algorithm>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

#include <absl/status/status.h>

#include "core/base/parallel.h"
#include "core/fidelity/surface_triangles.h"
#include "core/plan/prepared_mesh.h"
#include "core/plan/sample_fields.h"
#include "core/second_order/curved_edges.h"
#include "core/second_order/edge_numbers.h"

namespace tet {
namespace {

constexpr std::size_t kNodesPerRange = 1024;

/// Bends the edges of each grid's part towards its own surface.
absl::Status bend_all(const TetMesh& mesh,
                      const Shape& shape,
                      const MeshRequest& request,
                      const Cancellation& cancellation,
                      CurvedEdges& curved) {
  const MeshRequest asked = request_for_phi(request);
  const auto bend = [&](const Shape& one, std::uint64_t first, std::uint64_t count) {
    const absl::StatusOr<MeshedField> field = meshed_field(one, asked);
    if (!field.ok()) return field.status();
    curved.bend(field->phi, first, count, cancellation);
    return absl::OkStatus();
  };
  const GridList* const grids = grids_of(shape);
  if (grids == nullptr) return bend(shape, 0, mesh.header.vertex_count);
  const std::vector<MeshPart>& parts = mesh.header.parts;
  if (grids->size() != parts.size()) {
    return absl::InvalidArgumentError("the mesh is of other grids");
  }
  for (std::size_t i = 0; i < parts.size(); ++i) {
    auto status = bend((*grids)[i], parts[i].first_vertex, parts[i].vertex_count);
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

void store(const MeshHeader& header, const WorldPoint& p, std::span<std::byte> row) noexcept {
  if (header.coordinate_type == CoordinateType::kFloat64) {
    const std::array numbers{p.x, p.y, p.z};
    std::memcpy(row.data(), numbers.data(), sizeof(numbers));
  } else {
    const std::array numbers{static_cast<float>(p.x), static_cast<float>(p.y),
                             static_cast<float>(p.z)};
    std::memcpy(row.data(), numbers.data(), sizeof(numbers));
  }
}

/// Calls `fill(edge, lower, higher)` for every edge. Parallel.
template <class Fill>
void for_each_edge(const EdgeNumbers& edges, const Fill& fill) {
  for_each_index(
      edges.first.size() - 1, [&](std::size_t vertex) { edges.visit_from(vertex, fill); },
      kNodesPerRange);
}

ByteBuffer places_of(const TetMesh& mesh, const EdgeNumbers& edges, const CurvedEdges& curved) {
  const MeshHeader& header = mesh.header;
  const std::size_t row = ChunkSizes(header, 1, 0).positions;
  ByteBuffer positions(edges.count() * row);
  for_each_edge(edges, [&](std::uint64_t edge, std::uint64_t low, std::uint64_t high) {
    const WorldPoint a = mesh.stored_position(low), b = mesh.stored_position(high);
    const Vector off = curved.offset(edge);
    store(header, stored_middle(header, a, b, off), positions.bytes().subspan(edge * row, row));
  });
  return positions;
}

/// The mean of the ends' values.
void average_fields(const TetMesh& mesh,
                    const EdgeNumbers& edges,
                    std::span<std::byte> values) {
  const std::size_t width = mesh.header.field_values();
  const std::size_t row = width * sizeof(float);
  const std::byte* const old = mesh.fields.bytes().data();
  for_each_edge(edges, [&](std::uint64_t edge, std::uint64_t low, std::uint64_t high) {
    for (std::size_t k = 0; k < width; ++k) {
      float a = 0, b = 0;
      std::memcpy(&a, old + low * row + k * sizeof(float), sizeof(a));
      std::memcpy(&b, old + high * row + k * sizeof(float), sizeof(b));
      const float mean = a / 2 + b / 2;
      std::memcpy(values.data() + edge * row + k * sizeof(float), &mean, sizeof(mean));
    }
  });
}

/// The faces that both ends lie in; the last value of a row, where there are such.
void write_box_faces(const TetMesh& mesh,
                     const EdgeNumbers& edges,
                     std::span<std::byte> values) {
  if (mesh.header.fields.back().name != kCutFaceArray) return;
  const std::size_t row = mesh.header.field_values() * sizeof(float);
  for_each_edge(edges, [&](std::uint64_t edge, std::uint64_t low, std::uint64_t high) {
    const auto faces = static_cast<float>(box_faces_at(mesh, low) & box_faces_at(mesh, high));
    std::memcpy(values.data() + (edge + 1) * row - sizeof(faces), &faces, sizeof(faces));
  });
}

bool are_loaded(const std::vector<VertexField>& fields) {
  return !fields.empty() && std::ranges::all_of(fields, [](const VertexField& field) {
    return !field.components.empty();
  });
}

ByteBuffer fields_of(const TetMesh& mesh,
                     const EdgeNumbers& edges,
                     const MeshRequest& request,
                     std::span<const std::byte> positions) {
  const MeshHeader& header = mesh.header;
  if (header.fields.empty()) return {};
  ByteBuffer values(ChunkSizes(header, edges.count(), 0).fields);
  average_fields(mesh, edges, values.bytes());
  if (are_loaded(request.fields)) {
    const std::size_t place = ChunkSizes(header, 1, 0).positions,
                      row = ChunkSizes(header, 1, 0).fields;
    for_each_range(edges.count(), kNodesPerRange, [&](std::size_t begin, std::size_t end) {
      sample_fields(request.fields, header,
                    positions.subspan(begin * place, (end - begin) * place),
                    values.bytes().subspan(begin * row, (end - begin) * row));
    });
  }
  write_box_faces(mesh, edges, values.bytes());
  return values;
}

}  // namespace

absl::StatusOr<MiddleNodes> make_second_order(const TetMesh& mesh,
                                              const Shape& shape,
                                              const MeshRequest& request,
                                              const Cancellation& cancellation) {
  absl::StatusOr<EdgeNumbers> edges =
      number_edges(mesh.view(), mesh.header.vertex_count, cancellation);
  if (!edges.ok()) return edges.status();
  CurvedEdges curved(mesh, *edges, surface_triangles(mesh));
  if (auto status = bend_all(mesh, shape, request, cancellation, curved); !status.ok()) {
    return status;
  }
  curved.keep_tets_good(cancellation);
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  MiddleNodes middles;
  middles.count = edges->count();
  middles.positions = places_of(mesh, *edges, curved);
  middles.fields = fields_of(mesh, *edges, request, middles.positions.bytes());
  middles.curved = curved.curved();
  middles.straightened = curved.straightened();
  middles.of_tets = std::move(edges->of_tets);
  return middles;
}

}  // namespace tet
