// The library's arrays as numpy's.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "tetstream/mesh.h"

namespace tetstream::python {

namespace py = pybind11;

/// Rows of `width` values, or single values where it is 0.
inline std::vector<py::ssize_t> shape_of(std::size_t values, std::size_t width) {
  if (width == 0) return {static_cast<py::ssize_t>(values)};
  return {static_cast<py::ssize_t>(values / width), static_cast<py::ssize_t>(width)};
}

/// Makes numpy's arrays of spans. With an owner they are views, which keep the owner alive, and
/// are read-only where others see them, too; without one they are copies.
class ArrayMaker {
 public:
  enum class Owner : std::uint8_t { kShared, kAlone };

  explicit ArrayMaker(py::handle owner = {}, Owner kind = Owner::kShared)
      : owner_(owner), kind_(kind) {}

  template <class T>
  py::array make(std::span<const T> values, std::size_t width) const {
    if (!owner_) return py::array_t<T>(shape_of(values.size(), width), values.data());
    py::array view = py::array_t<T>(shape_of(values.size(), width), values.data(), owner_);
    if (kind_ == Owner::kShared) view.attr("setflags")(py::arg("write") = false);
    return view;
  }

  // A chunk without vertices, or without tets, has the types of all others.

  py::array points(const MeshColumns& columns, const MeshHeader& header) const {
    return header.float64 ? make(columns.points64, 3) : make(columns.points32, 3);
  }
  py::array tets(const MeshColumns& columns, const MeshHeader& header) const {
    return header.uint64 ? make(columns.tets64, 4) : make(columns.tets32, 4);
  }
  /// Returns None where the mesh has no regions.
  py::object regions(const MeshColumns& columns, const MeshHeader& header) const {
    if (!header.has_regions) return py::none();
    return make(columns.regions, 0);
  }
  /// Returns None where the mesh is of no segmentation.
  py::object labels(const MeshColumns& columns, const MeshHeader& header) const {
    if (header.labels.empty()) return py::none();
    return make(columns.labels, 0);
  }
  /// Returns None where the mesh has no fields.
  py::object field_rows(const MeshColumns& columns, const MeshHeader& header) const {
    if (header.field_values == 0) return py::none();
    return make(columns.fields, header.field_values);
  }

  // These return None where the mesh has no faces.

  py::object faces(const MeshColumns& columns, const MeshHeader& header) const {
    if (header.face_labels.empty()) return py::none();
    return header.uint64 ? make(columns.faces64, 3) : make(columns.faces32, 3);
  }
  py::object face_tets(const MeshColumns& columns, const MeshHeader& header) const {
    if (header.face_labels.empty()) return py::none();
    return header.uint64 ? make(columns.face_tets64, 0) : make(columns.face_tets32, 0);
  }
  py::object face_labels(const MeshColumns& columns, const MeshHeader& header) const {
    if (header.face_labels.empty()) return py::none();
    return make(columns.face_labels, 0);
  }

 private:
  py::handle owner_;
  Owner kind_;
};

}  // namespace tetstream::python
