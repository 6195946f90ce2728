#include "tetstream/client.h"

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/stl.h>

#include "client/python/extension/stream.h"

namespace tetstream::python {
namespace {

Client connect(const std::string& address, const ClientOptions& options) {
  return value_of(Client::connect(address, options));
}

template <class Solid>
StoredVolume upload(const Client& client, const Solid& solid, const CallOptions& options) {
  return call(options, [&](const WorkOptions& work) { return client.upload(solid, work); });
}

StoredVolume upload_file(const Client& client,
                         const std::string& path,
                         const std::string& grid,
                         const CallOptions& options) {
  return call(options,
              [&](const WorkOptions& work) { return client.upload_file(path, grid, work); });
}

template <class Solid>
Mesh mesh_there(const Client& client,
                const Solid& solid,
                const Request& request,
                const CallOptions& options) {
  return call(options,
              [&](const StreamOptions& work) { return client.mesh(solid, request, work); });
}

template <class Solid>
py::dict estimate_there(const Client& client,
                        const Solid& solid,
                        const Request& request,
                        const CallOptions& options) {
  return to_python(call(
      options, [&](const WorkOptions& work) { return client.estimate(solid, request, work); }));
}

template <class Solid>
std::unique_ptr<Stream> stream_there(const Client& client,
                                     const Solid& solid,
                                     const Request& request,
                                     const CallOptions& options,
                                     std::uint64_t first,
                                     std::optional<std::uint64_t> end) {
  return std::make_unique<Stream>(options, [&](const StreamOptions& work) {
    return client.stream(solid, request, work, chunks_of(first, end));
  });
}

template <class Solid>
void bind_calls(py::class_<Client>& client) {
  client.def("mesh", &mesh_there<Solid>)
      .def("estimate", &estimate_there<Solid>)
      .def("stream", &stream_there<Solid>, py::arg("solid"), py::arg("request"),
           py::arg("options"), py::arg("first") = 0, py::arg("end") = py::none());
}

py::dict capabilities(const Client& client, const CallOptions& options) {
  const Capabilities told =
      call(options, [&](const WorkOptions& work) { return client.capabilities(work); });
  return py::dict(py::arg("server_version") = told.server_version,
                  py::arg("algorithm_version") = told.algorithm_version,
                  py::arg("max_tets") = told.max_tets,
                  py::arg("max_store_bytes") = told.max_store_bytes,
                  py::arg("max_chunk_bytes") = told.max_chunk_bytes,
                  py::arg("max_concurrent_meshes") = told.max_concurrent_meshes);
}

void check_health(const Client& client,
                  const std::string& service,
                  const CallOptions& options) {
  Watch watch = options.watch();
  const WorkOptions work = options.connected(watch);
  const Status status = watch.call([&] { return client.health(service, work); });
  if (!status.ok()) raise_error(status);
}

}  // namespace

void bind_client(py::module_& module) {
  py::class_<ClientOptions>(module, "ClientOptions")
      .def(py::init<>())
      .def_readwrite("token", &ClientOptions::token)
      .def_readwrite("token_in_plain", &ClientOptions::token_in_plain)
      .def_readwrite("tls", &ClientOptions::tls)
      .def_readwrite("tls_ca", &ClientOptions::tls_ca)
      .def_readwrite("tls_cert", &ClientOptions::tls_cert)
      .def_readwrite("tls_key", &ClientOptions::tls_key)
      .def_readwrite("attempts", &ClientOptions::attempts)
      .def_readwrite("shared_memory", &ClientOptions::shared_memory);
  py::class_<StoredVolume>(module, "StoredVolume")
      .def(py::init<std::string, std::string, std::vector<std::string>>())
      .def_readonly("name", &StoredVolume::name)
      .def_readonly("grid", &StoredVolume::grid)
      .def_readonly("grids", &StoredVolume::grids);
  py::class_<Client> client(module, "Client");
  bind_calls<StoredVolume>(client);
  bind_calls<Scene>(client);
  client.def(py::init(&connect))
      .def("upload", &upload<Volume>)
      .def("upload", &upload<Labels>)
      .def("upload_file", &upload_file)
      .def("capabilities", &capabilities)
      .def("check_health", &check_health);
}

}  // namespace tetstream::python
