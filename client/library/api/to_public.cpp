#include "client/library/api/to_public.h"

#include <cstddef>
#include <span>
#include <utility>

#include <absl/strings/numbers.h>

#include "client/library/error_details.h"
#include "core/base/failure_name.h"

namespace tetstream {
namespace {

Point point_of(const tet::WorldPoint& point) { return {point.x, point.y, point.z}; }

/// A column of a mesh is aligned for its numbers, wherever a chunk begins in it.
template <class Number>
std::span<const Number> numbers(std::span<const std::byte> column) {
  return {reinterpret_cast<const Number*>(column.data()), column.size() / sizeof(Number)};
}

MeshColumns columns_from(const tet::MeshHeader& header, const tet::ConstColumns& from) {
  MeshColumns columns;
  if (header.coordinate_type == tet::CoordinateType::kFloat64) {
    columns.points64 = numbers<double>(from.positions);
  } else {
    columns.points32 = numbers<float>(from.positions);
  }
  if (header.index_type == tet::IndexType::kUint64) {
    columns.tets64 = numbers<std::uint64_t>(from.tets);
    columns.faces64 = numbers<std::uint64_t>(from.faces);
    columns.face_tets64 = numbers<std::uint64_t>(from.face_tets);
  } else {
    columns.tets32 = numbers<std::uint32_t>(from.tets);
    columns.faces32 = numbers<std::uint32_t>(from.faces);
    columns.face_tets32 = numbers<std::uint32_t>(from.face_tets);
  }
  // The column of a segmentation's mesh has the numbers of labels.
  if (header.has_regions) columns.regions = numbers<std::uint8_t>(from.regions);
  if (!header.labels.empty()) columns.labels = numbers<tet::LabelNumber>(from.regions);
  columns.fields = numbers<float>(from.fields);
  columns.face_labels = numbers<std::uint16_t>(from.face_labels);
  return columns;
}

Statistics::Quality quality_of(const tet::QualityStats& quality) {
  return {quality.min_dihedral_deg, quality.max_dihedral_deg, quality.volume,
          quality.histogram};
}

Statistics::Boundary boundary_of(const tet::BoundaryTopology& boundary) {
  return {boundary.triangles,          boundary.vertices,
          boundary.components,         boundary.euler_characteristic,
          boundary.non_manifold_edges, boundary.non_manifold_vertices};
}

Statistics::Improvement improvement_of(const tet::Improvement& improvement) {
  return {improvement.min_dihedral_before_deg, improvement.max_dihedral_before_deg,
          improvement.moved_vertices};
}

Statistics::SurfaceDistance distance_of(const tet::SurfaceDistance& distance) {
  return {distance.max, distance.rms, point_of(distance.at), distance.samples};
}

Statistics::Fidelity fidelity_of(const tet::Fidelity& fidelity) {
  return {fidelity.spacing,
          distance_of(fidelity.to_surface),
          distance_of(fidelity.from_surface),
          fidelity.mesh_area,
          fidelity.surface_area,
          fidelity.mesh_volume,
          fidelity.enclosed_volume};
}

Statistics::Ratio ratio_of(const tet::RatioSummary& ratio) {
  return {ratio.min, ratio.mean, ratio.max, ratio.histogram};
}

Statistics::Shapes shapes_of(const tet::ShapeSummary& shapes) {
  return {ratio_of(shapes.scaled_jacobian),
          ratio_of(shapes.radius_ratio),
          ratio_of(shapes.edge_ratio),
          shapes.shortest_edge,
          shapes.longest_edge,
          shapes.not_positive};
}

std::optional<std::uint64_t> number_of(const std::string& text) {
  std::uint64_t number = 0;
  if (!absl::SimpleAtoi(text, &number)) return std::nullopt;
  return number;
}

}  // namespace

Status to_public(const absl::Status& status) {
  if (status.ok()) return {};
  std::string reason = tet::failure_name(status);
  if (reason.empty()) reason = tet::reason_of_failure(status);
  return Status(static_cast<StatusCode>(status.code()), std::string(status.message()),
                std::move(reason))
      .with_details({.field = tet::field_of_failure(status),
                     .what = tet::metadata_of(status, "what"),
                     .value = number_of(tet::metadata_of(status, "value")),
                     .limit = number_of(tet::metadata_of(status, "limit")),
                     .request_id = tet::request_id_of(status)});
}

MeshHeader to_public(const tet::MeshHeader& header, std::string id) {
  MeshHeader result{.vertex_count = header.vertex_count,
                    .tet_count = header.tet_count,
                    .chunk_count = header.chunk_count,
                    .float64 = header.coordinate_type == tet::CoordinateType::kFloat64,
                    .uint64 = header.index_type == tet::IndexType::kUint64,
                    .has_regions = header.has_regions,
                    .origin = point_of(header.origin),
                    .bounds = {point_of(header.bounds.min), point_of(header.bounds.max)},
                    .spacing = header.spacing,
                    .levels = header.levels,
                    .fields = {},
                    .field_values = 0,
                    .parts = {},
                    .inside_guess = header.inside_guess,
                    .id = std::move(id),
                    .face_labels = {},
                    .face_count = header.face_count,
                    .labels = {}};
  for (const tet::FieldArray& field : header.fields) {
    result.fields.push_back({field.name, field.components, result.field_values});
    result.field_values += field.components;
  }
  for (const tet::MeshPart& part : header.parts) {
    result.parts.push_back(
        {part.name, part.first_vertex, part.vertex_count, part.first_tet, part.tet_count});
  }
  for (const tet::FaceLabel& label : header.face_labels) {
    result.face_labels.push_back(
        {label.name, static_cast<FaceLabel::Kind>(label.kind), label.part});
  }
  for (const tet::MeshLabel& label : header.labels) {
    result.labels.push_back({label.value, label.name});
  }
  return result;
}

Statistics to_public(const tet::TrailerFacts& facts) {
  Statistics statistics;
  if (facts.quality) statistics.quality = quality_of(*facts.quality);
  if (facts.boundary) statistics.boundary = boundary_of(*facts.boundary);
  if (facts.improvement) statistics.improvement = improvement_of(*facts.improvement);
  statistics.thin_walls = {facts.thin_walls.inside, facts.thin_walls.outside,
                           facts.thin_walls.suggested_spacing};
  if (!facts.fidelity) return statistics;
  for (const tet::Fidelity& part : facts.fidelity->parts) {
    statistics.fidelity.push_back(fidelity_of(part));
  }
  statistics.shapes = shapes_of(facts.fidelity->shapes);
  return statistics;
}

Chunk to_public(const tet::ChunkView& chunk, const tet::MeshHeader& header) {
  const tet::ChunkExtent& place = chunk.place;
  return {chunk.index,      place.first_vertex, place.vertex_count,
          place.first_tet,  place.tet_count,    columns_from(header, chunk.columns),
          place.first_face, place.face_count};
}

MeshColumns columns_of(const tet::TetMesh& mesh) {
  return columns_from(mesh.header, mesh.columns());
}

}  // namespace tetstream
