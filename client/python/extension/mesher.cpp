#include "tetstream/mesher.h"

#include <memory>
#include <optional>

#include "client/python/extension/stream.h"

namespace tetstream::python {
namespace {

template <class Solid>
Mesh mesh_here(const Solid& solid, const Request& request, const CallOptions& options) {
  return call(options, [&](const WorkOptions& work) { return mesh(solid, request, work); });
}

template <class Solid>
py::dict estimate_here(const Solid& solid, const Request& request, const CallOptions& options) {
  return to_python(
      call(options, [&](const WorkOptions& work) { return estimate(solid, request, work); }));
}

template <class Solid>
std::unique_ptr<Stream> stream_here(const Solid& solid,
                                    const Request& request,
                                    const CallOptions& options,
                                    std::uint64_t first,
                                    std::optional<std::uint64_t> end) {
  return std::make_unique<Stream>(options, [&](const WorkOptions& work) {
    return stream(solid, request, work, chunks_of(first, end));
  });
}

template <class Solid>
void bind_calls(py::module_& module) {
  module.def("mesh", &mesh_here<Solid>);
  module.def("estimate", &estimate_here<Solid>);
  module.def("stream", &stream_here<Solid>, py::arg("solid"), py::arg("request"),
             py::arg("options"), py::arg("first") = 0, py::arg("end") = py::none());
}

}  // namespace

py::dict to_python(const Estimate& estimate) {
  return py::dict(py::arg("vertex_count") = estimate.vertex_count,
                  py::arg("tet_count") = estimate.tet_count,
                  py::arg("chunk_count") = estimate.chunk_count,
                  py::arg("bytes") = estimate.bytes, py::arg("seconds") = estimate.seconds);
}

void bind_mesher(py::module_& module) {
  bind_calls<Volume>(module);
  bind_calls<Scene>(module);
  bind_calls<Labels>(module);
}

}  // namespace tetstream::python
