#include "tetstream/mesher.h"

#include <memory>

#include "client/python/extension/stream.h"

namespace tetstream::python {
namespace {

Mesh mesh_here(const Volume& volume, const Request& request, const CallOptions& options) {
  return call(options, [&](const WorkOptions& work) { return mesh(volume, request, work); });
}

py::dict estimate_here(const Volume& volume,
                       const Request& request,
                       const CallOptions& options) {
  return to_python(
      call(options, [&](const WorkOptions& work) { return estimate(volume, request, work); }));
}

std::unique_ptr<Stream> stream_here(const Volume& volume,
                                    const Request& request,
                                    const CallOptions& options) {
  return std::make_unique<Stream>(
      options, [&](const WorkOptions& work) { return stream(volume, request, work); });
}

}  // namespace

py::dict to_python(const Estimate& estimate) {
  return py::dict(py::arg("vertex_count") = estimate.vertex_count,
                  py::arg("tet_count") = estimate.tet_count, py::arg("bytes") = estimate.bytes,
                  py::arg("seconds") = estimate.seconds);
}

void bind_mesher(py::module_& module) {
  module.def("mesh", &mesh_here);
  module.def("estimate", &estimate_here);
  module.def("stream", &stream_here);
}

}  // namespace tetstream::python
