// The service over loopback: a real server and the C++ client in one process. Meshes arrive in
// the client's own arrays, every checksum checked.
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <random>
#include <string>
#include <unistd.h>
#include <utility>
#include <vector>

#include <absl/status/statusor.h>
#include <benchmark/benchmark.h>

#include "client/mesh_client.h"
#include "server/logging.h"
#include "server/server.h"
#include "tests/support/vdb_fixtures.h"

namespace tet::bench {
namespace {

template <class T>
T checked(absl::StatusOr<T> value) {
  if (value.ok()) return *std::move(value);
  std::fprintf(stderr, "%s\n", value.status().ToString().c_str());
  std::abort();
}

/// A server with an empty store, and a client; gone with all their files when this is.
class Loopback {
 public:
  Loopback() : folder_(std::filesystem::temp_directory_path() / unique_name()) {
    std::filesystem::create_directories(folder_);
    Config config;
    config.listen = "127.0.0.1:0";
    config.store = file("store");
    config.store_bytes = std::uint64_t{1} << 30;  // what benchmarks upload pushes older out
    server_ = checked(Server::start(config));
    client_ = MeshClient::connect(server_->address());
  }
  ~Loopback() {
    client_.reset();
    server_.reset();
    std::filesystem::remove_all(folder_);
  }
  Loopback(const Loopback&) = delete;
  Loopback& operator=(const Loopback&) = delete;

  MeshClient& client() { return *client_; }
  std::string file(const std::string& name) const { return (folder_ / name).string(); }
  const Cancellation& never() const { return never_; }

 private:
  static std::string unique_name() { return "tet-bench-" + std::to_string(::getpid()); }

  std::filesystem::path folder_;
  Cancellation never_;
  std::unique_ptr<Server> server_;
  std::unique_ptr<MeshClient> client_;
};

enum class Planning { kEachTime, kOnce };

/// Uploads a ball and asks for its uniform mesh.
v1::MeshRequest request_ball(Loopback& loopback, double voxel_size) {
  const std::string path = loopback.file("ball.vdb");
  test::write_fixture("sphere", voxel_size, path);
  v1::MeshRequest request;
  request.set_name(checked(loopback.client().upload_file(path, {}, loopback.never())));
  request.set_levels(0);
  request.set_spacing(voxel_size);
  return request;
}

/// Meshes a ball `radius` voxels large: about 50 radius^3 tets.
void stream(benchmark::State& state, double radius, Planning planning) {
  Loopback loopback;
  v1::MeshRequest request = request_ball(loopback, 1 / radius);
  checked(
      loopback.client().stream_mesh(request, {}, loopback.never()));  // loads the grid, plans
  double tets = 0, bytes = 0;
  for (auto _ : state) {
    // Another spacing is another mesh, which nobody remembers; one so near is the same lattice.
    if (planning == Planning::kEachTime) request.set_spacing(request.spacing() * (1 + 1e-12));
    const StreamedMesh streamed =
        checked(loopback.client().stream_mesh(request, {}, loopback.never()));
    tets += static_cast<double>(streamed.mesh.header.tet_count);
    bytes += static_cast<double>(streamed.mesh.positions.size() + streamed.mesh.tets.size());
  }
  state.counters["tets"] = tets / static_cast<double>(state.iterations());
  state.counters["tets/s"] = benchmark::Counter(tets, benchmark::Counter::kIsRate);
  state.SetBytesProcessed(static_cast<std::int64_t>(bytes));
}

/// Uploads bytes that the server never saw, digests on both sides included.
void upload(benchmark::State& state, std::size_t size) {
  Loopback loopback;
  const std::string path = loopback.file("bytes");
  std::mt19937_64 random(1);  // any seed: only that blocks differ matters
  std::vector<std::uint64_t> words(size / sizeof(std::uint64_t));
  for (std::uint64_t& word : words) word = random();
  for (auto _ : state) {
    state.PauseTiming();
    words.front() = random();
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(words.data()), static_cast<std::streamsize>(size));
    state.ResumeTiming();
    checked(loopback.client().upload_file(path, {}, loopback.never()));
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(size) * state.iterations());
}

void add_stream(const std::string& size, double radius) {
  const auto add = [&](const std::string& name, Planning planning) {
    benchmark::RegisterBenchmark(
        name.c_str(), [=](benchmark::State& state) { stream(state, radius, planning); })
        ->Unit(benchmark::kMillisecond)
        ->MeasureProcessCPUTime()
        ->UseRealTime();
  };
  add("stream/ball/" + size + "/planned_each_time", Planning::kEachTime);
  add("stream/ball/" + size + "/planned_once", Planning::kOnce);
}

void add_upload(const std::string& size, std::size_t bytes) {
  benchmark::RegisterBenchmark(("upload/" + size).c_str(),
                               [=](benchmark::State& state) { upload(state, bytes); })
      ->Unit(benchmark::kMillisecond)
      ->MeasureProcessCPUTime()
      ->UseRealTime();
}

}  // namespace
}  // namespace tet::bench

int main(int argc, char** argv) {
  using namespace tet::bench;
  tet::start_logging("error");
  add_stream("1e5", 12.6);
  add_stream("1e6", 27.1);
  add_stream("1e7", 58.4);
  add_upload("1MiB", std::size_t{1} << 20);
  add_upload("64MiB", std::size_t{1} << 26);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
