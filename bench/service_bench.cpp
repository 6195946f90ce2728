// The service over loopback: a real server and the C++ client in one process, so that the CPU
// time is that of both ends. Meshes arrive in the client's own arrays, every checksum checked.
// Beside them, in the same run, what bounds them: the same mesh made in this process, and gRPC
// alone.
#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include "bench/checked.h"
#include "bench/loopback.h"
#include "bench/raw_grpc.h"
#include "core/plan/make/mesher.h"
#include "core/plan/make/plan_mesh.h"
#include "core/vdb/openvdb/load.h"
#include "proto/wire/sha256.h"
#include "proto/wire/transport.h"
#include "server/ops/logging.h"
#include "tests/support/vdb_fixtures.h"

namespace tet::bench {
namespace {

/// Adds up what runs delivered, and what CPU time they took.
class Delivered {
 public:
  void add(const TetMesh& mesh) {
    tets_ += static_cast<double>(mesh.header.tet_count);
    bytes_ += static_cast<double>(mesh.positions.size() + mesh.tets.size());
  }
  void report(benchmark::State& state) const {
    state.counters["tets"] = tets_ / static_cast<double>(state.iterations());
    state.counters["tets/s"] = benchmark::Counter(tets_, benchmark::Counter::kIsRate);
    state.counters["tets/cpu_s"] = tets_ / (process_cpu_seconds() - cpu_before_);
    state.SetBytesProcessed(static_cast<std::int64_t>(bytes_));
  }

 private:
  const double cpu_before_ = process_cpu_seconds();
  double tets_ = 0, bytes_ = 0;
};

/// Bytes a second, and a CPU second.
void report_bytes(benchmark::State& state, double bytes, double cpu_before) {
  state.SetBytesProcessed(static_cast<std::int64_t>(bytes));
  state.counters["bytes/cpu_s"] = bytes / (process_cpu_seconds() - cpu_before);
}

enum class Planning { kEachTime, kOnce };

/// Into the arrays of the mesh before, which a client gives back.
void stream(benchmark::State& state,
            const BenchMesh& mesh,
            Planning planning,
            v1::Encoding encoding = v1::ENCODING_PLAIN,
            Transport transport = Transport::kPort) {
  Loopback loopback(transport);
  v1::MeshRequest request = loopback.request_mesh(mesh);
  TetMesh received = receive(loopback.client(), request);
  Delivered delivered;
  for (auto _ : state) {
    if (planning == Planning::kEachTime) rename_mesh(request);
    received = receive(loopback.client(), request, std::move(received), encoding);
    delivered.add(received);
  }
  delivered.report(state);
}

/// Makes the mesh in this process, to compare with: the grid is loaded, and the memory is that
/// of the mesh before.
void make_here(benchmark::State& state, const BenchMesh& mesh, Planning planning) {
  const std::string path = std::filesystem::temp_directory_path() / "tet-bench-solid.vdb";
  test::write_fixture(mesh.solid, mesh.voxel_size, path);
  const auto volume = std::make_shared<const Volume>(checked(load_volume(path, "")));
  std::filesystem::remove(path);
  TaskPool pool;
  MeshRequest request;
  if (!mesh.graded) request.levels = 0;
  const auto plan = [&] { return checked(plan_mesh({.shape = volume, .request = request})); };
  const auto fill = [](const MeshPlan& planned, TetMesh used) {
    return std::move(checked(fill_mesh(planned, {}, nullptr, std::move(used))).mesh);
  };
  std::shared_ptr<const MeshPlan> planned;
  TetMesh made;
  pool.run([&] {
    planned = plan();
    made = fill(*planned, {});
  });
  Delivered delivered;
  for (auto _ : state) {
    pool.run([&] {
      if (planning == Planning::kEachTime) planned = plan();
      made = fill(*planned, std::move(made));
    });
    delivered.add(made);
  }
  delivered.report(state);
}

/// Several clients, each with a connection and arrays of its own, at once.
void stream_side_by_side(benchmark::State& state, const BenchMesh& mesh, int streams) {
  Loopback loopback;
  const v1::MeshRequest request = loopback.request_mesh(mesh);
  std::vector<std::unique_ptr<MeshClient>> clients;
  clients.reserve(static_cast<std::size_t>(streams));
  for (int i = 0; i < streams; ++i) clients.push_back(loopback.connect());
  std::vector<TetMesh> meshes(clients.size());
  Delivered delivered;
  for (auto _ : state) {
    {
      std::vector<std::jthread> threads;
      for (std::size_t i = 0; i < clients.size(); ++i) {
        threads.emplace_back(
            [&, i] { meshes[i] = receive(*clients[i], request, std::move(meshes[i])); });
      }
    }
    for (const TetMesh& received : meshes) delivered.add(received);
  }
  delivered.report(state);
}

/// From the request to the first chunk in the client's array: real time.
void first_chunk(benchmark::State& state, const BenchMesh& mesh, Planning planning) {
  using Clock = std::chrono::steady_clock;
  Loopback loopback;
  v1::MeshRequest request = loopback.request_mesh(mesh);
  for (auto _ : state) {
    if (planning == Planning::kEachTime) rename_mesh(request);
    Cancellation enough;
    Clock::time_point arrived{};
    ClientProgress progress;
    progress.tets = [&](std::uint64_t done, std::uint64_t) {
      if (done == 0 || arrived != Clock::time_point{}) return;
      arrived = Clock::now();
      enough.cancel();
    };
    const Clock::time_point asked = Clock::now();
    benchmark::DoNotOptimize(loopback.client().stream_mesh(request, progress, enough));
    state.SetIterationTime(std::chrono::duration<double>(arrived - asked).count());
  }
}

/// Uploads bytes that the server never saw, digests on both sides and the disk included.
void upload(benchmark::State& state, std::size_t size) {
  Loopback loopback;
  const std::string path = loopback.file("bytes");
  std::mt19937_64 random(1);  // any seed: only that blocks differ matters
  std::vector<std::uint64_t> words(size / sizeof(std::uint64_t));
  for (std::uint64_t& word : words) word = random();
  double cpu_seconds = 0;
  for (auto _ : state) {
    state.PauseTiming();
    words.front() = random();
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(words.data()), static_cast<std::streamsize>(size));
    const double before = process_cpu_seconds();
    state.ResumeTiming();
    checked(loopback.client().upload_file(path, {}, {}));
    cpu_seconds += process_cpu_seconds() - before;
  }
  const double bytes = static_cast<double>(size) * static_cast<double>(state.iterations());
  state.SetBytesProcessed(static_cast<std::int64_t>(bytes));
  state.counters["bytes/cpu_s"] = bytes / cpu_seconds;
}

/// SHA-256 alone, which an upload takes at both ends.
void digest(benchmark::State& state, std::size_t size) {
  const std::string bytes(size, 'x');
  const double cpu_before = process_cpu_seconds();
  for (auto _ : state) {
    Sha256 sha256;
    sha256.add(bytes);
    benchmark::DoNotOptimize(sha256.finish_hex());
  }
  report_bytes(state, static_cast<double>(size) * static_cast<double>(state.iterations()),
               cpu_before);
}

using Transfer = void (RawGrpc::*)(std::size_t messages, std::size_t message_bytes);

/// gRPC alone: nothing is made, checked or kept.
void raw(benchmark::State& state, Transfer transfer, std::size_t message_bytes) {
  constexpr std::size_t kTotal = std::size_t{1} << 28;
  RawGrpc grpc;
  const std::size_t messages = kTotal / message_bytes;
  (grpc.*transfer)(messages / 8, message_bytes);  // connects, and fills the allocator's lists
  const double cpu_before = process_cpu_seconds();
  for (auto _ : state) (grpc.*transfer)(messages, message_bytes);
  report_bytes(state, static_cast<double>(kTotal) * static_cast<double>(state.iterations()),
               cpu_before);
}

template <class Body>
benchmark::internal::Benchmark* add(const std::string& name, const Body& body) {
  return benchmark::RegisterBenchmark(name.c_str(), body)
      ->Unit(benchmark::kMillisecond)
      ->MeasureProcessCPUTime()
      ->UseRealTime();
}

/// A mesh, and its name in those of benchmarks. Sizes are of uniform meshes.
struct NamedMesh {
  std::string name;
  BenchMesh mesh;
};

NamedMesh ball(const std::string& size, double radius, bool graded = false) {
  return {"ball/" + size + (graded ? "/graded" : "/uniform"), {"sphere", 1 / radius, graded}};
}

NamedMesh torus(const std::string& size, double voxel_size, bool graded) {
  return {"torus/" + size + (graded ? "/graded" : "/uniform"), {"torus", voxel_size, graded}};
}

NamedMesh gyroid(const std::string& size, double voxels, bool graded) {
  return {"gyroid/" + size + (graded ? "/graded" : "/uniform"), {"gyroid", 1 / voxels, graded}};
}

void add_mesh(const NamedMesh& named) {
  using enum Planning;
  const auto add_both = [&](const std::string& when, Planning planning) {
    add("here/" + named.name + when,
        [=](benchmark::State& state) { make_here(state, named.mesh, planning); });
    add("stream/" + named.name + when,
        [=](benchmark::State& state) { stream(state, named.mesh, planning); });
  };
  add_both("/planned_each_time", kEachTime);
  add_both("/planned_once", kOnce);
}

void add_encoded(const NamedMesh& named) {
  const auto add_both = [&](const std::string& way, v1::Encoding encoding) {
    const auto add_one = [&](const std::string& when, Planning planning) {
      add(way + "/" + named.name + when,
          [=](benchmark::State& state) { stream(state, named.mesh, planning, encoding); });
    };
    add_one("/planned_each_time", Planning::kEachTime);
    add_one("/planned_once", Planning::kOnce);
  };
  add_both("stream_packed", v1::ENCODING_PACKED);
  add_both("stream_compact", v1::ENCODING_COMPACT);
}

/// On one host: over a socket file, and with chunks in shared memory.
void add_local(const NamedMesh& named) {
  const auto add_one = [&](const std::string& way, Transport transport) {
    add(way + "/" + named.name + "/planned_each_time", [=](benchmark::State& state) {
      stream(state, named.mesh, Planning::kEachTime, v1::ENCODING_PLAIN, transport);
    });
  };
  add_one("stream_unix", Transport::kSocketFile);
  add_one("stream_shared", Transport::kSharedMemory);
}

void add_first_chunk(const NamedMesh& named) {
  const auto add_one = [&](const std::string& when, Planning planning) {
    const std::string name = "first_chunk/" + named.name + when;
    benchmark::RegisterBenchmark(
        name.c_str(),
        [=](benchmark::State& state) { first_chunk(state, named.mesh, planning); })
        ->Unit(benchmark::kMillisecond)
        ->UseManualTime();
  };
  add_one("/planned_each_time", Planning::kEachTime);
  add_one("/planned_once", Planning::kOnce);
}

void add_side_by_side(const NamedMesh& named) {
  for (const int streams : {1, 2, 4, 16}) {
    add("stream/" + named.name + "/streams:" + std::to_string(streams),
        [=](benchmark::State& state) { stream_side_by_side(state, named.mesh, streams); });
  }
}

void add_upload(const std::string& size, std::size_t bytes) {
  add("upload/" + size, [=](benchmark::State& state) { upload(state, bytes); });
}

void add_raw(const std::string& size, std::size_t bytes) {
  add("raw/stream/" + size,
      [=](benchmark::State& state) { raw(state, &RawGrpc::stream, bytes); });
  add("raw/upload/" + size,
      [=](benchmark::State& state) { raw(state, &RawGrpc::upload, bytes); });
}

}  // namespace
}  // namespace tet::bench

int main(int argc, char** argv) {
  using namespace tet::bench;
  tet::keep_read_blocks();
  tet::start_logging("error");
  constexpr std::array<std::pair<const char*, double>, 3> kBalls{
      {{"1e5", 12.6}, {"1e6", 27.1}, {"1e7", 58.4}}};
  std::vector<NamedMesh> meshes;
  for (const bool graded : {false, true}) {
    for (const auto& [size, radius] : kBalls) meshes.push_back(ball(size, radius, graded));
    meshes.push_back(torus("1e6", 0.0336, graded));
    meshes.push_back(gyroid("1e7", 66.7, graded));
  }
  for (const NamedMesh& mesh : meshes) add_mesh(mesh);
  for (const NamedMesh& mesh : meshes) add_encoded(mesh);
  for (const NamedMesh& mesh : meshes) add_local(mesh);
  add_first_chunk(ball("1e5", 12.6));
  add_first_chunk(ball("1e7", 58.4));
  add_side_by_side(ball("1e6", 27.1));
  add_upload("1MiB", std::size_t{1} << 20);
  add_upload("64MiB", std::size_t{1} << 26);
  add("digest/64MiB", [](benchmark::State& state) { digest(state, std::size_t{1} << 26); });
  add_raw("64KiB", std::size_t{1} << 16);
  add_raw("256KiB", std::size_t{1} << 18);
  add_raw("512KiB", std::size_t{1} << 19);
  add_raw("1MiB", std::size_t{1} << 20);
  add_raw("4MiB", std::size_t{1} << 22);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
