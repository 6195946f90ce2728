#include "tetstream/labels.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "client/python/extension/bindings.h"

namespace tetstream::python {
namespace {

using Ends = std::pair<std::int64_t, std::int64_t>;

template <class T>
bool take(const py::array& array, LabelValues& values) {
  using Typed = py::array_t<T, py::array::c_style>;
  if (!py::isinstance<Typed>(array)) return false;
  values = std::span<const T>(static_cast<const T*>(array.data()),
                              static_cast<std::size_t>(array.size()));
  return true;
}

/// Python has seen to it that the array is contiguous and of one of these types.
LabelValues values_of(const py::array& array) {
  LabelValues values;
  const bool taken = take<std::uint8_t>(array, values) || take<std::int8_t>(array, values) ||
                     take<std::uint16_t>(array, values) || take<std::int16_t>(array, values) ||
                     take<std::uint32_t>(array, values) || take<std::int32_t>(array, values) ||
                     take<std::uint64_t>(array, values) || take<std::int64_t>(array, values);
  if (!taken) raise_error({StatusCode::kInvalidArgument, "labels are no integers"});
  return values;
}

Labels from_voxels(const py::array& array,
                   const Point& origin,
                   const std::array<Point, 3>& steps) {
  const LabelArray labels{.values = values_of(array),
                          .size = {static_cast<std::size_t>(array.shape(0)),
                                   static_cast<std::size_t>(array.shape(1)),
                                   static_cast<std::size_t>(array.shape(2))},
                          .origin = origin,
                          .steps = steps};
  return without_gil([&] { return Labels::from_voxels(labels); });
}

Labels from_file(const std::string& path, const std::string& name, bool trusted) {
  return without_gil([&] { return Labels::from_file(path, {name, trusted}); });
}

void write_nrrd(const Labels& labels, const std::string& path) {
  const Status status = [&] {
    const py::gil_scoped_release released;
    return labels.write_nrrd(path);
  }();
  if (!status.ok()) raise_error(status);
}

std::vector<std::pair<std::int64_t, std::uint64_t>> counts_of(const Labels& labels) {
  std::vector<std::pair<std::int64_t, std::uint64_t>> counts;
  for (const LabelCount& count : labels.counts()) {
    counts.emplace_back(count.value, count.voxels);
  }
  return counts;
}

std::vector<LabelRange> ranges_of(const std::vector<Ends>& ends) {
  std::vector<LabelRange> ranges;
  ranges.reserve(ends.size());
  for (const auto& [first, last] : ends) ranges.push_back({first, last});
  return ranges;
}

std::vector<std::pair<std::int64_t, std::string>> names_in(const std::string& path) {
  std::vector<std::pair<std::int64_t, std::string>> names;
  for (const MeshLabel& label : value_of(read_label_names(path))) {
    names.emplace_back(label.value, label.name);
  }
  return names;
}

}  // namespace

void bind_labels(py::module_& module) {
  py::class_<Labels>(module, "Labels")
      .def_static("from_voxels", &from_voxels)
      .def_static("from_file", &from_file)
      .def_static("from_level_sets",
                  [](const std::vector<Volume>& volumes) {
                    return value_of(Labels::from_level_sets(volumes));
                  })
      .def_property_readonly("counts", &counts_of)
      .def_property_readonly("voxel_edges",
                             [](const Labels& labels) { return labels.voxel_edges(); })
      .def("write_nrrd", &write_nrrd);
  py::enum_<LabelSmoothing>(module, "LabelSmoothing")
      .value("gauss", LabelSmoothing::kGauss)
      .value("thin", LabelSmoothing::kThin)
      .value("none", LabelSmoothing::kNone);
  py::class_<LabelChoice>(module, "LabelChoice")
      .def(py::init<>())
      .def("set_only", [](LabelChoice& choice,
                          const std::vector<Ends>& ends) { choice.only = ranges_of(ends); })
      .def("add_merge",
           [](LabelChoice& choice, const std::vector<Ends>& ends) {
             choice.merges.push_back(ranges_of(ends));
           })
      .def("add_name",
           [](LabelChoice& choice, std::int64_t value, std::string name) {
             choice.names.push_back({value, std::move(name)});
           })
      .def("add_size",
           [](LabelChoice& choice, std::int64_t first, std::int64_t last, double size) {
             choice.sizes.push_back({{first, last}, size});
           })
      .def_readwrite("background", &LabelChoice::background)
      .def_readwrite("mesh_background", &LabelChoice::mesh_background)
      .def_readwrite("smoothing", &LabelChoice::smoothing)
      .def_readwrite("smooth", &LabelChoice::smooth);
  module.def("read_label_names", &names_in);
}

}  // namespace tetstream::python
