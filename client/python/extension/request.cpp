#include "tetstream/request.h"

#include <optional>
#include <string>
#include <utility>

#include <pybind11/stl.h>

#include "client/python/extension/bindings.h"

namespace tetstream::python {
namespace {

void set_box(Request& request, const std::optional<std::pair<Point, Point>>& box) {
  request.box.reset();
  if (box) request.box = Box{box->first, box->second};
}

void add_field(Request& request, std::string name, const Volume& values) {
  request.fields.push_back({std::move(name), values});
}

void add_stored_field(Request& request, std::string name, const StoredVolume& stored) {
  request.fields.push_back({std::move(name), std::nullopt, stored});
}

}  // namespace

void bind_request(py::module_& module) {
  py::enum_<Preset>(module, "Preset")
      .value("default", Preset::kDefault)
      .value("min_angle", Preset::kMinAngle)
      .value("both_sides", Preset::kBothSides);
  py::enum_<Coordinates>(module, "Coordinates")
      .value("automatic", Coordinates::kAutomatic)
      .value("float32", Coordinates::kFloat32)
      .value("float64", Coordinates::kFloat64);
  py::enum_<Encoding>(module, "Encoding")
      .value("plain", Encoding::kPlain)
      .value("packed", Encoding::kPacked)
      .value("compact", Encoding::kCompact);
  py::enum_<Inside>(module, "Inside")
      .value("above", Inside::kAbove)
      .value("below", Inside::kBelow);
  py::class_<Request>(module, "Request")
      .def(py::init<>())
      .def_readwrite("spacing", &Request::spacing)
      .def_readwrite("iso", &Request::iso)
      .def_readwrite("inside", &Request::inside)
      .def_readwrite("levels", &Request::levels)
      .def_readwrite("preset", &Request::preset)
      .def("set_box", &set_box)
      .def_readwrite("sizing", &Request::sizing)
      .def_readwrite("improve", &Request::improve)
      .def_readwrite("manifold", &Request::manifold)
      .def_readwrite("statistics", &Request::statistics)
      .def_readwrite("faces", &Request::faces)
      .def_readwrite("fidelity", &Request::fidelity)
      .def_readwrite("face_regions", &Request::face_regions)
      .def_readwrite("coordinates", &Request::coordinates)
      .def_readwrite("labels", &Request::labels)
      .def("add_field", &add_field)
      .def("add_field", &add_stored_field);
  py::class_<std::stop_source>(module, "Stop")
      .def(py::init<>())
      .def("request", [](std::stop_source& stop) { stop.request_stop(); })
      .def_property_readonly(
          "requested", [](const std::stop_source& stop) { return stop.stop_requested(); });
  py::class_<CallOptions>(module, "Options")
      .def(py::init<>())
      .def_readwrite("progress", &CallOptions::progress)
      .def_readwrite("deadline", &CallOptions::deadline)
      .def_readwrite("threads", &CallOptions::threads)
      .def_readwrite("encoding", &CallOptions::encoding)
      .def_readwrite("skip_cache", &CallOptions::skip_cache)
      .def_readwrite("stop", &CallOptions::stop);
}

}  // namespace tetstream::python
