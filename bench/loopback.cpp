#include "bench/loopback.h"

#include <cstdint>
#include <unistd.h>
#include <utility>

#include "bench/checked.h"
#include "core/plan/mesh_request.h"
#include "tests/support/vdb_fixtures.h"

namespace tet::bench {

namespace {

std::string unique_name() { return "tet-bench-" + std::to_string(::getpid()); }

Config config_in(const std::string& store) {
  Config config;
  config.listen = "127.0.0.1:0";
  config.store = store;
  config.jobs = "off";
  config.store_bytes = std::uint64_t{1} << 30;  // what benchmarks upload pushes older out
  return config;
}

}  // namespace

Loopback::Loopback(Transport transport)
    : transport_(transport), folder_(std::filesystem::temp_directory_path() / unique_name()) {
  std::filesystem::create_directories(folder_);
  Config config = config_in(file("store"));
  if (transport != Transport::kPort) config.listen_unix = file("socket");
  server_ = checked(Server::start(config));
  client_ = connect();
}

Loopback::~Loopback() {
  client_.reset();
  server_.reset();
  std::filesystem::remove_all(folder_);
}

std::unique_ptr<MeshClient> Loopback::connect() const {
  if (transport_ == Transport::kPort) return MeshClient::connect(server_->address());
  ChannelOptions options;
  options.shared_memory = transport_ == Transport::kSharedMemory;
  return checked(MeshClient::connect(server_->unix_address(), options));
}

v1::MeshRequest Loopback::request_mesh(const BenchMesh& mesh) {
  test::write_fixture(mesh.solid, mesh.voxel_size, file("solid.vdb"));
  v1::MeshRequest request;
  request.set_name(checked(client_->upload_file(file("solid.vdb"), {}, {})));
  request.set_levels(mesh.graded ? kMaxLevels : 0);
  request.set_spacing(mesh.voxel_size);
  receive(*client_, request);
  return request;
}

// Another spacing is another mesh; one so near is the same lattice.
void rename_mesh(v1::MeshRequest& request) {
  request.set_spacing(request.spacing() * (1 + 1e-12));
}

TetMesh receive(MeshClient& client,
                const v1::MeshRequest& request,
                TetMesh used,
                v1::Encoding encoding) {
  StreamOptions options{.encoding = encoding, .used = std::move(used)};
  return std::move(checked(client.stream_mesh(request, {}, {}, std::move(options))).mesh);
}

}  // namespace tet::bench
