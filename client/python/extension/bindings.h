// The parts of the module, one function a source; a part may use the types of those before it.
#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>

#include <pybind11/pybind11.h>

#include "client/python/extension/watch.h"
#include "tetstream/client.h"
#include "tetstream/jobs.h"

namespace tetstream::python {

/// How a caller of Python wants a call to be made, here or on a server.
struct CallOptions {
  py::object progress = py::none();
  std::optional<double> deadline = {};  ///< seconds since 1970
  int threads = 0;
  Encoding encoding = Encoding::kPlain;
  bool skip_cache = false;
  std::stop_source stop{};  ///< by which another thread may stop it

  Watch watch() const { return {progress, deadline, stop}; }
  StreamOptions connected(const Watch& watch) const {
    StreamOptions options;
    watch.connect(options);
    options.threads = threads;
    options.encoding = encoding;
    options.skip_cache = skip_cache;
    return options;
  }
};

/// Waits for `work`, which gets the options, and returns its value.
template <class Function>
auto call(const CallOptions& options, const Function& work) {
  Watch watch = options.watch();
  const StreamOptions connected = options.connected(watch);
  auto value = value_of(watch.call([&] { return work(connected); }));
  watch.finish();
  return value;
}

/// Other threads of Python run while `make` does, which must not touch anything of Python.
template <class Function>
auto without_gil(const Function& make) {
  return value_of([&] {
    const py::gil_scoped_release released;
    return make();
  }());
}

py::dict to_python(const MeshHeader& header);
py::dict to_python(const Statistics& statistics);
py::dict to_python(const Estimate& estimate);
py::dict to_python(const Job& job);
py::object to_python(const JobEvent& event);

/// Chunks from `first` on; to `end` where that is given.
inline ChunkRange chunks_of(std::uint64_t first, std::optional<std::uint64_t> end) {
  return {first, end};
}

void bind_volume(py::module_& module);
void bind_labels(py::module_& module);
void bind_request(py::module_& module);
void bind_mesh(py::module_& module);
void bind_stream(py::module_& module);
void bind_mesher(py::module_& module);
void bind_client(py::module_& module);
void bind_samples(py::module_& module);
void bind_session(py::module_& module);
void bind_jobs(py::module_& module);

}  // namespace tetstream::python
