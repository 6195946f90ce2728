// A file read by a decoder beside the same file read in this process: what the other process
// costs.
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <sys/resource.h>
#include <utility>

#include <benchmark/benchmark.h>

#include "bench/checked.h"
#include "core/base/parallel.h"
#include "core/vdb/decoder/decode_file.h"
#include "core/vdb/decoder/decoder_supply.h"
#include "core/vdb/openvdb/load.h"
#include "tests/support/vdb_fixtures.h"

namespace tet::bench {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr std::uint64_t kMaxBytes = std::uint64_t{4} << 30;

/// A ball's file, made when it is first asked for.
std::string ball_file(double voxel) {
  static const std::filesystem::path folder = [] {
    std::string pattern = std::filesystem::temp_directory_path() / "decode_bench.XXXXXX";
    return std::filesystem::path(::mkdtemp(pattern.data()));
  }();
  std::atexit([] { std::filesystem::remove_all(folder); });
  const std::string path = folder / (std::to_string(voxel) + ".vdb");
  if (!std::filesystem::exists(path)) test::write_fixture("sphere", voxel, path);
  return path;
}

FileRequest request_for(const std::string& path) {
  return {DecodeTask::kVolume, path, path, "", kMaxBytes};
}

/// OpenVDB in this process.
double read_here(const std::string& path) {
  const auto start = Clock::now();
  checked(load_volume(path, ""));
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// The decoder is started for it.
double read_cold(const std::string& path) {
  const FileRequest request = request_for(path);
  const auto start = Clock::now();
  checked(volume_of(decode_once(request, {}, nullptr), request));
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// A decoder stands ready: a copy of one that was started before the first.
double read_warm(const std::string& path) {
  thread_local DecoderSupply supply(DecoderProgram{});
  Decoder decoder = checked(supply.take(nullptr));
  if (!decoder.wait_until_ready(nullptr).ok()) std::abort();
  const FileRequest request = request_for(path);
  const auto start = Clock::now();
  const CheckedFile file = checked(check_request(request, 60s));
  checked(volume_of(decoder.decode(file.order, file.file.number(), {file.limit, nullptr}),
                    request));
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// CPU time of this process and of all decoders that have ended, milliseconds.
double cpu_ms() {
  double ms = 0;
  for (const auto who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage used{};
    ::getrusage(who, &used);
    for (const timeval& time : {used.ru_utime, used.ru_stime}) {
      ms += static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_usec) / 1e3;
    }
  }
  return ms;
}

void measure(benchmark::State& state, double (*read)(const std::string&), double voxel) {
  const std::string path = ball_file(voxel);
  const auto bytes = static_cast<double>(std::filesystem::file_size(path));
  const double cpu_before = cpu_ms();
  TaskPool pool;
  pool.run([&] {
    for (auto _ : state) state.SetIterationTime(read(path));
  });
  state.counters["file_bytes"] = bytes;
  state.counters["cpu_ms"] =
      benchmark::Counter(cpu_ms() - cpu_before, benchmark::Counter::kAvgIterations);
  state.counters["bytes/s"] =
      benchmark::Counter(bytes, benchmark::Counter::kIsIterationInvariantRate);
}

void register_all() {
  const auto add = [](const std::string& way, double (*read)(const std::string&)) {
    for (const auto& [size, voxel] : {std::pair("small", 0.02), std::pair("large", 0.0025)}) {
      benchmark::RegisterBenchmark(
          ("read/" + way + "/ball/" + size).c_str(),
          [read, at = voxel](benchmark::State& state) { measure(state, read, at); })
          ->UseManualTime()
          ->Unit(benchmark::kMillisecond);
    }
  };
  add("here", read_here);
  add("warm", read_warm);
  add("cold", read_cold);
}

}  // namespace
}  // namespace tet::bench

int main(int argc, char** argv) {
  tet::bench::register_all();
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
