// The encodings of graded meshes, on one thread: making compact chunks from a plan, and the
// mesh from them; packing chunks that are made, and unpacking them.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include "bench/bench_fields.h"
#include "core/base/parallel.h"
#include "core/mesh/packed/packed_chunk.h"
#include "core/plan/make/fill_mesh.h"
#include "core/plan/make/plan_mesh.h"
#include "core/plan/mesh_workspace.h"
#include "core/transfer/compact_mesh.h"

namespace tet::bench {
namespace {

using Chunks = std::vector<std::vector<std::byte>>;
using Plan = std::shared_ptr<const BrickPlan>;

Plan make_plan(Solid solid, const BenchSize& size) {
  return as_bricks(plan_mesh({.shape = make_solid(solid, size)}).value());
}

Chunks encode(const BrickPlan& plan) {
  Chunks chunks(plan.header().chunk_count);
  MeshWorkspace workspace;
  for (std::size_t i = 0; i < chunks.size(); ++i) encode_chunk(plan, i, workspace, chunks[i]);
  return chunks;
}

TetMesh decode(const BrickPlan& plan, const Chunks& chunks, TetMesh used = {}) {
  CompactBricks bricks(compact_frame(plan).rules.both_sides);
  for (const auto& chunk : chunks) {
    if (!bricks.add(chunk).ok()) return {};
  }
  auto filled =
      decode_mesh(std::move(bricks), plan.header(), compact_frame(plan), {}, std::move(used));
  return std::move(filled.value().mesh);
}

void count(benchmark::State& state, const BrickPlan& plan, const Chunks& chunks) {
  const auto tets = static_cast<double>(plan.header().tet_count);
  double bytes = 0;
  for (const auto& chunk : chunks) bytes += static_cast<double>(chunk.size());
  state.counters["bytes/tet"] = bytes / tets;
  state.counters["tets/s"] =
      benchmark::Counter(tets, benchmark::Counter::kIsIterationInvariantRate);
}

void run_encode(benchmark::State& state, const BrickPlan& plan) {
  for (auto _ : state) benchmark::DoNotOptimize(encode(plan));
  count(state, plan, encode(plan));
}

/// Into the memory of the mesh before.
void run_decode(benchmark::State& state, const BrickPlan& plan) {
  const Chunks chunks = encode(plan);
  TetMesh mesh = decode(plan, chunks);
  for (auto _ : state) mesh = decode(plan, chunks, std::move(mesh));
  count(state, plan, chunks);
}

/// A mesh as chunks.
struct ChunkedMesh {
  TetMesh mesh;
  std::vector<ChunkExtent> extents;

  explicit ChunkedMesh(const BrickPlan& plan)
      : mesh(std::move(fill_mesh(plan, {}, nullptr).value().mesh)) {
    for (std::uint64_t i = 0; i < plan.header().chunk_count; ++i) {
      extents.push_back(plan.chunk(i));
    }
  }

  void pack(ChunkPacker& packer, Chunks& chunks) {
    chunks.resize(extents.size());
    for (std::size_t i = 0; i < extents.size(); ++i) {
      const auto bytes = packer.pack(mesh.header, extents[i], mesh.columns_of(extents[i]));
      chunks[i].assign(bytes.begin(), bytes.end());
    }
  }
};

void run_pack(benchmark::State& state, const BrickPlan& plan) {
  ChunkedMesh made(plan);
  ChunkPacker packer;
  Chunks chunks;
  for (auto _ : state) made.pack(packer, chunks);
  count(state, plan, chunks);
}

/// Into the memory of the mesh before.
void run_unpack(benchmark::State& state, const BrickPlan& plan) {
  ChunkedMesh made(plan);
  ChunkPacker packer;
  Chunks chunks;
  made.pack(packer, chunks);
  ChunkUnpacker unpacker;
  for (auto _ : state) {
    for (std::size_t i = 0; i < chunks.size(); ++i) {
      const ChunkExtent& extent = made.extents[i];
      const ChunkColumns columns = made.mesh.columns_of(extent);
      if (!unpacker.unpack(chunks[i], made.mesh.header, extent, columns).ok()) {
        return state.SkipWithError("a chunk that was packed is refused");
      }
    }
  }
  count(state, plan, chunks);
}

using Run = void (*)(benchmark::State& state, const BrickPlan& plan);

/// Registers `encode/solid/size` and the like; rates are of CPU time.
void add(const std::string& what, Run run, Solid solid, const BenchSize& size) {
  const std::string name = what + "/" + name_of(solid) + "/" + size.label;
  benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
    TaskPool pool(1);
    pool.run([&] { run(state, *make_plan(solid, size)); });
  })->Unit(benchmark::kMillisecond);
}

}  // namespace
}  // namespace tet::bench

int main(int argc, char** argv) {
  using namespace tet::bench;
  for (const BenchSize& size : {kSmall, kMedium, kLarge}) {
    for (const Solid solid : kSolids) {
      add("encode", run_encode, solid, size);
      add("decode", run_decode, solid, size);
      add("pack", run_pack, solid, size);
      add("unpack", run_unpack, solid, size);
    }
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
