// Writes known meshes in every format, with their contents as JSON beside them, for
// read_back.py.
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <map>
#include <string>

#include <nlohmann/json.hpp>

#include "core/files/mesh_file.h"
#include "core/mesh/find_faces.h"
#include "core/second_order/edge_numbers.h"
#include "tests/core/mesh/small_meshes.h"

namespace tet {
namespace {

TetMesh with_bounds(TetMesh mesh) {
  mesh.header.bounds = {mesh.vertex(0), mesh.vertex(0)};
  for (std::uint64_t i = 1; i < mesh.header.vertex_count; ++i) {
    const WorldPoint p = mesh.vertex(i);
    WorldBox& box = mesh.header.bounds;
    box.min = {std::min(box.min.x, p.x), std::min(box.min.y, p.y), std::min(box.min.z, p.z)};
    box.max = {std::max(box.max.x, p.x), std::max(box.max.y, p.y), std::max(box.max.z, p.z)};
  }
  return mesh;
}

/// Rows of numbers by the array's name.
nlohmann::json fields_of(const FileMesh& mesh) {
  nlohmann::json fields = nlohmann::json::object();
  if (mesh.mesh.header.fields.empty()) return fields;
  for (std::uint64_t i = 0; i < mesh.shape().nodes; ++i) {
    const auto* value = reinterpret_cast<const float*>(mesh.field_row(i));
    for (const FieldArray& field : mesh.mesh.header.fields) {
      const std::vector<float> row(value, value + field.components);
      fields[field.name].push_back(row);
      value += field.components;
    }
  }
  return fields;
}

/// Two grids' meshes: the first `tets` tets, and the rest.
TetMesh in_two_parts(TetMesh mesh, std::uint64_t tets) {
  const std::uint64_t rest = mesh.header.tet_count - tets;
  mesh.header.parts = {{"femur \"left\"", 0, 1, 0, tets, 1, 0},
                       {"a/b <c> & d", 1, mesh.header.vertex_count - 1, tets, rest, 1, 0}};
  return mesh;
}

/// The mesh's own faces, or those that are found.
FoundFaces faces_in(const TetMesh& mesh) {
  if (!mesh.header.has_faces()) return find_faces(mesh);
  std::vector<TetFace> faces;
  std::map<std::uint64_t, std::uint16_t> labels;
  for (std::uint64_t i = 0; i < mesh.header.face_count; ++i) {
    const std::uint64_t tet = mesh.face_tet(i);
    faces.push_back({4 * tet + opposite_corner(mesh.tet(tet), mesh.face(i))});
    labels[faces.back().index] = mesh.face_label(i);
  }
  return {std::move(faces), mesh.header.face_labels,
          [labels = std::move(labels)](const TetFace& face, const Triangle&) {
            return labels.at(face.index);
          }};
}

/// By label: a triangle's nodes.
template <std::size_t kNodes>
nlohmann::json faces_of(const FileMesh& mesh) {
  nlohmann::json faces = nlohmann::json::object();
  const FoundFaces found = faces_in(mesh.mesh);
  for (const TetFace& face : found.faces) {
    const Triangle triangle = face_of(mesh.mesh.tet(face.tet()), face.opposite());
    faces[found.labels[found.label(face, triangle)].name].push_back(
        nodes_of_face(mesh.nodes_of<kNodes>(face.tet()), face.opposite()));
  }
  return faces;
}

/// A mesh of both sides with faces of its own, of which a half of the interface has a name that
/// a request gave it.
TetMesh with_half_named(TetMesh mesh) {
  FoundFaces found = find_faces(mesh);
  const auto half = static_cast<std::uint16_t>(found.labels.size());
  found.labels.push_back({.name = "half", .kind = FaceKind::kRegion});
  const double middle = mesh.vertex(mesh.header.vertex_count / 2).x;
  found.label = [&mesh, half, middle, label = std::move(found.label)](
                    const TetFace& face, const Triangle& triangle) {
    const std::uint16_t own = label(face, triangle);
    const bool is_low = mesh.vertex(triangle[0]).x < middle;
    return own == 0 && is_low ? half : own;
  };
  set_faces(found, mesh, mesh);
  return mesh;
}

/// A node in the middle of each edge, off the straight line, and values that all differ.
MiddleNodes middles_of(const TetMesh& mesh) {
  EdgeNumbers edges = *number_edges(mesh.view(), mesh.header.vertex_count);
  MiddleNodes middles;
  middles.count = edges.count();
  const CoordinateType type = mesh.header.coordinate_type;
  middles.positions = ByteBuffer(middles.count * 3 * size_of(type));
  for (std::uint64_t vertex = 0; vertex < mesh.header.vertex_count; ++vertex) {
    edges.visit_from(vertex, [&](std::uint64_t edge, std::uint64_t low, std::uint64_t high) {
      const MeshView view = mesh.view();
      const auto a = view.stored_position(low), b = view.stored_position(high);
      const std::array middle{0.5 * (a.x + b.x) + 0.01, 0.5 * (a.y + b.y), 0.5 * (a.z + b.z)};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t place = 3 * edge + axis;
        if (type == CoordinateType::kFloat64) {
          internal::store(middles.positions.bytes(), place, middle[axis]);
        } else {
          internal::store(middles.positions.bytes(), place, static_cast<float>(middle[axis]));
        }
      }
    });
  }
  const std::uint64_t values = middles.count * mesh.header.field_values();
  middles.fields = ByteBuffer(values * sizeof(float));
  for (std::uint64_t i = 0; i < values; ++i) {
    internal::store(middles.fields.bytes(), i, -0.25F * static_cast<float>(i));
  }
  middles.of_tets = std::move(edges.of_tets);
  return middles;
}

/// Labels with and without names, in turn.
TetMesh with_labels(TetMesh mesh, std::int64_t first_value) {
  mesh.header.labels = {{first_value, "bone \"left\""}, {7, ""}, {11175, "<grey> & white"}};
  mesh.regions = ByteBuffer(mesh.header.tet_count * sizeof(LabelNumber));
  for (std::uint64_t i = 0; i < mesh.header.tet_count; ++i) {
    const auto number = static_cast<LabelNumber>(i % mesh.header.labels.size());
    std::memcpy(mesh.regions.bytes().data() + i * sizeof(number), &number, sizeof(number));
  }
  return mesh;
}

template <std::size_t kNodes>
nlohmann::json contents_of(const FileMesh& nodes) {
  const TetMesh& mesh = nodes.mesh;
  nlohmann::json points = nlohmann::json::array(), tets = points, regions = points;
  nlohmann::json parts = points;
  for (std::uint64_t i = 0; i < nodes.shape().nodes; ++i) {
    const auto [x, y, z] = nodes.node(i);
    points.push_back({x, y, z});
  }
  for (std::uint64_t i = 0; i < mesh.header.tet_count; ++i) {
    tets.push_back(nodes.nodes_of<kNodes>(i));
    if (mesh.header.has_regions) regions.push_back(mesh.region(i));
    if (!mesh.header.labels.empty()) regions.push_back(mesh.header.labels[mesh.label(i)].value);
    if (!mesh.header.parts.empty()) parts.push_back(i < mesh.header.parts[1].first_tet ? 1 : 2);
  }
  return {{"points", points},   {"tets", tets},   {"faces", faces_of<kNodes>(nodes)},
          {"regions", regions}, {"parts", parts}, {"fields", fields_of(nodes)}};
}

absl::Status write_sample(const std::string& path, TetMesh unbounded) {
  const TetMesh mesh = with_bounds(std::move(unbounded));
  if (auto status = write_text_file(path + ".json", contents_of<4>({mesh}).dump());
      !status.ok()) {
    return status;
  }
  for (const MeshFormatRow& row : mesh_formats()) {
    const std::string to = path + std::string(row.ending);
    if (auto status = write_mesh_file(to, mesh); !status.ok()) return status;
  }
  return absl::OkStatus();
}

/// In the formats that have meshes of second order, with middle nodes of their own.
absl::Status write_second_sample(const std::string& path, TetMesh unbounded) {
  const TetMesh mesh = with_bounds(std::move(unbounded));
  const MiddleNodes middles = middles_of(mesh);
  const FileMesh nodes{mesh, &middles};
  absl::Status status = write_text_file(path + ".json", contents_of<10>(nodes).dump());
  for (const MeshFormatRow& row : mesh_formats()) {
    const MeshOutput output{path + std::string(row.ending), row.format};
    const absl::Status written = write_mesh_file(output, nodes);
    if (!row.second_order.empty()) {
      status.Update(written);
    } else if (!absl::IsInvalidArgument(written)) {
      status.Update(absl::InternalError(output.path + " was not refused"));
    }
  }
  return status;
}

/// What the table says that each format carries.
nlohmann::json formats() {
  nlohmann::json rows = nlohmann::json::array();
  for (const MeshFormatRow& row : mesh_formats()) {
    rows.push_back({{"name", row.name},
                    {"ending", row.ending},
                    {"tets", !row.tets.empty()},
                    {"regions", !row.regions.empty()},
                    {"faces", !row.faces.empty()},
                    {"second_order", !row.second_order.empty()},
                    {"fields", !row.fields.empty()},
                    {"coordinates", row.coordinates}});
  }
  return rows;
}

absl::Status write_samples(const std::string& directory) {
  const auto all = [](int, int, int) { return true; };
  const auto every_third = [](std::uint64_t tet) { return tet % 3 == 1; };
  const auto none = [](std::uint64_t) { return false; };
  const Storage far{.origin = {20000.4, -20000.1, 1e6}};
  const Storage wide{.coordinates = CoordinateType::kFloat64,
                     .ids = IndexType::kUint64,
                     .origin = {0.1, 0, 0}};
  absl::Status status = write_text_file(directory + "/formats.json", formats().dump());
  status.Update(write_sample(directory + "/one", one_tet()));
  status.Update(write_sample(directory + "/near", kuhn_mesh(6)));
  status.Update(write_sample(directory + "/moved", kuhn_mesh(3, all, {.origin = {5, -7, 9}})));
  status.Update(write_sample(directory + "/far", kuhn_mesh(5, all, far)));
  status.Update(write_sample(directory + "/wide", kuhn_mesh(4, all, wide)));
  // Larger than one block of the writer in every column, in rows that do not fill blocks
  // evenly; those below with fields in the narrow types, too.
  status.Update(write_sample(directory + "/blocks", kuhn_mesh(33, all, wide)));
  // Tets of a region, or of a part, take more than one block as text: 27,000 lines do.
  status.Update(write_sample(directory + "/sides", with_regions(kuhn_mesh(24), every_third)));
  status.Update(write_sample(directory + "/half",
                             with_half_named(with_regions(kuhn_mesh(6), every_third))));
  status.Update(write_sample(directory + "/outside", with_regions(kuhn_mesh(2), none)));
  const std::vector<FieldArray> fields{{"heat", 1}, {"flow <x> & co", 3}, {"Druck in MPa", 1}};
  status.Update(write_sample(directory + "/field", with_fields(kuhn_mesh(4), {{"flow", 3}})));
  status.Update(write_sample(directory + "/fields",
                             with_fields(with_regions(kuhn_mesh(33), every_third), fields)));
  status.Update(write_sample(directory + "/parts",
                             with_fields(in_two_parts(kuhn_mesh(24), 40'001), fields)));
  status.Update(write_second_sample(directory + "/second_one", one_tet()));
  status.Update(write_second_sample(directory + "/second_far", kuhn_mesh(5, all, far)));
  status.Update(write_second_sample(directory + "/second_sides",
                                    with_regions(kuhn_mesh(4), every_third)));
  status.Update(write_second_sample(directory + "/second_field",
                                    with_fields(kuhn_mesh(4, all, wide), {{"flow", 3}})));
  status.Update(write_second_sample(directory + "/second_parts",
                                    with_fields(in_two_parts(kuhn_mesh(17), 10'001), fields)));
  TetMesh tissues = with_labels(kuhn_mesh(9), 4);
  tissues.header.labels[0].name = "bone";
  tissues.header.labels[2] = {9, "fat/skin"};
  status.Update(write_sample(directory + "/tissues", std::move(tissues)));
  status.Update(write_sample(directory + "/labels", with_labels(kuhn_mesh(9), -3)));
  status.Update(
      write_sample(directory + "/large_labels", with_labels(kuhn_mesh(2), 3'000'000'000)));
  return status;
}

}  // namespace
}  // namespace tet

int main(int, char** arguments) {
  const absl::Status status = tet::write_samples(arguments[1]);
  if (!status.ok()) std::fprintf(stderr, "%s\n", status.ToString().c_str());
  return status.ok() ? 0 : 1;
}
