#include "tetstream/volume.h"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "client/python/extension/bindings.h"

namespace tetstream::python {
namespace {

template <class T>
using Array = py::array_t<T, py::array::c_style>;

template <class T>
std::span<const T> span_of(const Array<T>& array) {
  return {array.data(), static_cast<std::size_t>(array.size())};
}

/// Where the samples of an array lie, and what they are.
struct Samples {
  double spacing = 1;
  Point origin{};
  VolumeKind kind = VolumeKind::kLevelSet;
  std::optional<float> background = {};
};

Volume from_samples(const Array<float>& values, const Samples& samples) {
  const SampleArray array{.values = span_of(values),
                          .size = {static_cast<std::size_t>(values.shape(0)),
                                   static_cast<std::size_t>(values.shape(1)),
                                   static_cast<std::size_t>(values.shape(2))},
                          .spacing = samples.spacing,
                          .origin = samples.origin,
                          .kind = samples.kind,
                          .background = samples.background};
  return without_gil([&] { return Volume::from_samples(array); });
}

Volume from_triangles(const Array<double>& points,
                      const Array<std::uint32_t>& triangles,
                      double voxel_size,
                      OpenSurface open) {
  const Triangles surface{span_of(points), span_of(triangles)};
  return without_gil([&] { return Volume::from_triangles(surface, voxel_size, open); });
}

Volume from_surface_file(const std::string& path, double voxel_size, OpenSurface open) {
  return without_gil([&] { return Volume::from_surface_file(path, voxel_size, open); });
}

Scene scene_from_json(const std::string& json,
                      const std::vector<std::pair<std::string, Volume>>& volumes) {
  std::vector<SceneGrid> grids;
  grids.reserve(volumes.size());
  for (const auto& [name, volume] : volumes) grids.push_back({name, volume});
  const py::gil_scoped_release released;
  Result<Scene> scene = Scene::from_json(json, grids);
  const py::gil_scoped_acquire held;
  return value_of(std::move(scene));
}

Volume from_vdb(const std::string& path, const std::string& grid, bool trusted) {
  return without_gil([&] { return Volume::from_vdb(path, {grid, trusted}); });
}

Volume values_from_vdb(const std::string& path, const std::string& grid, bool trusted) {
  return without_gil([&] { return Volume::values_from_vdb(path, {grid, trusted}); });
}

void write_vdb(const Volume& volume, const std::string& path) {
  const Status status = [&] {
    const py::gil_scoped_release released;
    return volume.write_vdb(path);
  }();
  if (!status.ok()) raise_error(status);
}

}  // namespace

void bind_volume(py::module_& module) {
  py::enum_<VolumeKind>(module, "VolumeKind")
      .value("level_set", VolumeKind::kLevelSet)
      .value("density", VolumeKind::kDensity)
      .value("values", VolumeKind::kValues);
  py::enum_<OpenSurface>(module, "OpenSurface")
      .value("refuse", OpenSurface::kRefuse)
      .value("close", OpenSurface::kClose)
      .value("shell", OpenSurface::kShell);
  py::class_<Samples>(module, "Samples")
      .def(py::init<double, Point, VolumeKind, std::optional<float>>());
  py::class_<Volume>(module, "Volume")
      .def_static("from_samples", &from_samples)
      .def_static("from_triangles", &from_triangles)
      .def_static("from_surface_file", &from_surface_file)
      .def_static("from_vdb", &from_vdb)
      .def_static("values_from_vdb", &values_from_vdb)
      .def_property_readonly("kind", [](const Volume& volume) { return volume.kind(); })
      .def_property_readonly("voxel_size",
                             [](const Volume& volume) { return volume.voxel_size(); })
      .def("write_vdb", &write_vdb);
  py::class_<Scene>(module, "Scene").def_static("from_json", &scene_from_json);
}

}  // namespace tetstream::python
