#include "tetstream/mesh.h"

#include <array>
#include <string>

#include <pybind11/stl.h>

#include "client/python/extension/arrays.h"
#include "client/python/extension/bindings.h"
#include "tetstream/mesh_file.h"

namespace tetstream::python {
namespace {

py::list fields_of(const MeshHeader& header) {
  py::list fields;
  for (const FieldArray& field : header.fields) {
    fields.append(py::make_tuple(field.name, field.components, field.offset));
  }
  return fields;
}

py::list parts_of(const MeshHeader& header) {
  py::list parts;
  for (const MeshPart& part : header.parts) {
    parts.append(py::make_tuple(part.name, part.first_vertex, part.vertex_count, part.first_tet,
                                part.tet_count));
  }
  return parts;
}

py::list face_labels_of(const MeshHeader& header) {
  constexpr std::array kKinds{"", "surface", "interface", "box", "region"};
  py::list labels;
  for (const FaceLabel& label : header.face_labels) {
    labels.append(py::make_tuple(label.name, kKinds.at(static_cast<std::size_t>(label.kind)),
                                 label.part));
  }
  return labels;
}

py::list labels_of(const MeshHeader& header) {
  py::list labels;
  for (const MeshLabel& label : header.labels) {
    labels.append(py::make_tuple(label.value, label.name));
  }
  return labels;
}

py::object quality_of(const std::optional<Statistics::Quality>& quality) {
  if (!quality) return py::none();
  const std::span<const std::uint64_t> histogram(quality->histogram);
  return py::dict(py::arg("min_dihedral_deg") = quality->min_dihedral_deg,
                  py::arg("max_dihedral_deg") = quality->max_dihedral_deg,
                  py::arg("volume") = quality->volume,
                  py::arg("histogram") = ArrayMaker().make(histogram, 0));
}

py::object boundary_of(const std::optional<Statistics::Boundary>& boundary) {
  if (!boundary) return py::none();
  return py::dict(py::arg("triangles") = boundary->triangles,
                  py::arg("vertices") = boundary->vertices,
                  py::arg("components") = boundary->components,
                  py::arg("euler_characteristic") = boundary->euler_characteristic,
                  py::arg("non_manifold_edges") = boundary->non_manifold_edges,
                  py::arg("non_manifold_vertices") = boundary->non_manifold_vertices);
}

py::object improvement_of(const std::optional<Statistics::Improvement>& improvement) {
  if (!improvement) return py::none();
  return py::dict(py::arg("min_dihedral_before_deg") = improvement->min_dihedral_before_deg,
                  py::arg("max_dihedral_before_deg") = improvement->max_dihedral_before_deg,
                  py::arg("moved_vertices") = improvement->moved_vertices);
}

py::dict distance_of(const Statistics::SurfaceDistance& distance) {
  return py::dict(py::arg("max") = distance.max, py::arg("rms") = distance.rms,
                  py::arg("at") = py::tuple(py::cast(distance.at)),
                  py::arg("samples") = distance.samples);
}

py::list fidelity_of(const Statistics& statistics) {
  py::list parts;
  for (const Statistics::Fidelity& part : statistics.fidelity) {
    parts.append(py::dict(py::arg("spacing") = part.spacing,
                          py::arg("mesh_to_surface") = distance_of(part.mesh_to_surface),
                          py::arg("surface_to_mesh") = distance_of(part.surface_to_mesh),
                          py::arg("mesh_area") = part.mesh_area,
                          py::arg("surface_area") = part.surface_area,
                          py::arg("mesh_volume") = part.mesh_volume,
                          py::arg("enclosed_volume") = part.enclosed_volume));
  }
  return parts;
}

py::dict ratio_of(const Statistics::Ratio& ratio) {
  const std::span<const std::uint64_t> histogram(ratio.histogram);
  return py::dict(py::arg("min") = ratio.min, py::arg("mean") = ratio.mean,
                  py::arg("max") = ratio.max,
                  py::arg("histogram") = ArrayMaker().make(histogram, 0));
}

py::object shapes_of(const std::optional<Statistics::Shapes>& shapes) {
  if (!shapes) return py::none();
  return py::dict(py::arg("scaled_jacobian") = ratio_of(shapes->scaled_jacobian),
                  py::arg("radius_ratio") = ratio_of(shapes->radius_ratio),
                  py::arg("edge_ratio") = ratio_of(shapes->edge_ratio),
                  py::arg("shortest_edge") = shapes->shortest_edge,
                  py::arg("longest_edge") = shapes->longest_edge,
                  py::arg("not_positive") = shapes->not_positive);
}

void write(const Mesh& mesh,
           const std::string& path,
           const std::string& format,
           const CallOptions& options) {
  Watch watch = options.watch();
  const StreamOptions connected = options.connected(watch);
  const Status status =
      watch.call([&] { return write_mesh_file(path, mesh, format, connected); });
  if (!status.ok()) raise_error(status);
  watch.finish();
}

/// An array of a mesh that Python holds.
template <class Function>
auto of_mesh(const Function& array) {
  return [array](const py::object& self) {
    const auto& mesh = self.cast<const Mesh&>();
    return array(ArrayMaker(self), mesh.columns(), mesh.header());
  };
}

}  // namespace

py::dict to_python(const MeshHeader& header) {
  return py::dict(
      py::arg("vertex_count") = header.vertex_count, py::arg("tet_count") = header.tet_count,
      py::arg("chunk_count") = header.chunk_count, py::arg("float64") = header.float64,
      py::arg("uint64") = header.uint64, py::arg("has_regions") = header.has_regions,
      py::arg("origin") = py::tuple(py::cast(header.origin)),
      py::arg("bounds") = py::make_tuple(py::tuple(py::cast(header.bounds.min)),
                                         py::tuple(py::cast(header.bounds.max))),
      py::arg("spacing") = header.spacing, py::arg("levels") = header.levels,
      py::arg("fields") = fields_of(header), py::arg("parts") = parts_of(header),
      py::arg("id") = header.id, py::arg("face_labels") = face_labels_of(header),
      py::arg("face_count") = header.face_count, py::arg("labels") = labels_of(header),
      py::arg("inside_guess") = header.inside_guess);
}

py::dict to_python(const Statistics& statistics) {
  const Statistics::ThinWalls& thin = statistics.thin_walls;
  return py::dict(
      py::arg("quality") = quality_of(statistics.quality),
      py::arg("boundary") = boundary_of(statistics.boundary),
      py::arg("improvement") = improvement_of(statistics.improvement),
      py::arg("thin_walls") = py::make_tuple(thin.inside, thin.outside, thin.suggested_spacing),
      py::arg("empty_face_regions") = py::tuple(py::cast(statistics.empty_face_regions)),
      py::arg("fidelity") = fidelity_of(statistics),
      py::arg("shapes") = shapes_of(statistics.shapes));
}

void bind_mesh(py::module_& module) {
  using Header = const MeshHeader&;
  using Columns = const MeshColumns&;
  py::class_<Mesh>(module, "Mesh")
      .def_property_readonly("header",
                             [](const Mesh& mesh) { return to_python(mesh.header()); })
      .def_property_readonly("statistics",
                             [](const Mesh& mesh) { return to_python(mesh.statistics()); })
      .def_property_readonly(
          "points", of_mesh([](ArrayMaker maker, Columns columns, Header header) -> py::object {
            return maker.points(columns, header);
          }))
      .def_property_readonly(
          "tets", of_mesh([](ArrayMaker maker, Columns columns, Header header) -> py::object {
            return maker.tets(columns, header);
          }))
      .def_property_readonly("regions",
                             of_mesh([](ArrayMaker maker, Columns columns, Header header) {
                               return maker.regions(columns, header);
                             }))
      .def_property_readonly("field_rows",
                             of_mesh([](ArrayMaker maker, Columns columns, Header header) {
                               return maker.field_rows(columns, header);
                             }))
      .def_property_readonly("faces",
                             of_mesh([](ArrayMaker maker, Columns columns, Header header) {
                               return maker.faces(columns, header);
                             }))
      .def_property_readonly("face_tets",
                             of_mesh([](ArrayMaker maker, Columns columns, Header header) {
                               return maker.face_tets(columns, header);
                             }))
      .def_property_readonly("face_labels",
                             of_mesh([](ArrayMaker maker, Columns columns, Header header) {
                               return maker.face_labels(columns, header);
                             }))
      .def_property_readonly("labels",
                             of_mesh([](ArrayMaker maker, Columns columns, Header header) {
                               return maker.labels(columns, header);
                             }))
      .def("write", &write);
}

}  // namespace tetstream::python
