#include "tetstream/sample.h"

#include <span>

#include "client/python/extension/arrays.h"
#include "client/python/extension/bindings.h"
#include "tetstream/client.h"

namespace tetstream::python {
namespace {

/// Points as Python hands them over: rows of x, y and z, which are kept while they are read.
using PointRows = py::array_t<double, py::array::c_style | py::array::forcecast>;

std::span<const double> numbers_of(const PointRows& points) {
  return {points.data(), static_cast<std::size_t>(points.size())};
}

py::dict to_python(const PointSamples& samples) {
  const ArrayMaker copies;
  py::list arrays;
  for (const FieldArray& array : samples.arrays) {
    arrays.append(py::make_tuple(array.name, array.components, array.offset));
  }
  return py::dict(py::arg("phi") = copies.make(std::span<const double>(samples.phi), 0),
                  py::arg("slopes") = copies.make(std::span<const double>(samples.slopes), 3),
                  py::arg("field_rows") =
                      copies.make(std::span<const float>(samples.fields), samples.field_values),
                  py::arg("arrays") = arrays, py::arg("inside_guess") = samples.inside_guess);
}

template <class Solid>
py::dict sample_here(const Solid& solid,
                     const PointRows& points,
                     const Request& request,
                     const CallOptions& options) {
  const std::span<const double> numbers = numbers_of(points);
  return to_python(call(
      options, [&](const WorkOptions& work) { return sample(solid, numbers, request, work); }));
}

template <class Solid>
py::dict sample_there(const Client& client,
                      const Solid& solid,
                      const PointRows& points,
                      const Request& request,
                      const CallOptions& options) {
  const std::span<const double> numbers = numbers_of(points);
  return to_python(call(options, [&](const WorkOptions& work) {
    return client.sample(solid, numbers, request, work);
  }));
}

}  // namespace

void bind_samples(py::module_& module) {
  module.def("sample", &sample_here<Volume>)
      .def("sample", &sample_here<Scene>)
      .def("sample_there", &sample_there<StoredVolume>)
      .def("sample_there", &sample_there<Scene>);
}

}  // namespace tetstream::python
