// Counting a mesh that several hosts share: alone, a block's survey, and all from the blocks of
// others. On one thread.
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include "bench/bench_fields.h"
#include "bench/checked.h"
#include "core/base/parallel.h"
#include "core/plan/brick/divided_survey.h"
#include "core/plan/make/plan_mesh.h"

namespace tet::bench {
namespace {

/// A mesh to be counted, in how many blocks.
struct Counted {
  std::shared_ptr<const Volume> volume;
  MeshRequest request;
  std::size_t block_bricks = 0;
};

constexpr std::size_t kBlocks = 8;

Counted make_counted(Solid solid, const BenchSize& size, bool uniform) {
  Counted counted{make_solid(solid, size), {}, 1};
  if (uniform) counted.request.levels = 0;
  const std::size_t bricks =
      checked(count_survey_blocks(counted.volume, counted.request, {}, 1, Cancellation()));
  counted.block_bricks = (bricks + kBlocks - 1) / kBlocks;
  return counted;
}

std::vector<std::byte> survey(const Counted& counted, std::size_t block) {
  return checked(survey_block(counted.volume, counted.request, {}, counted.block_bricks, block,
                              Cancellation()));
}

void plan(const Counted& counted, const SurveyedBlocks& surveyed) {
  benchmark::DoNotOptimize(checked(
      plan_mesh({.shape = counted.volume, .request = counted.request, .surveyed = surveyed})));
}

void add(Solid solid, const BenchSize& size, bool uniform) {
  const std::string of =
      std::string("/") + name_of(solid) + "/" + size.label + (uniform ? "/uniform" : "/graded");
  const auto bench = [&](const std::string& name, auto body) {
    benchmark::RegisterBenchmark((name + of).c_str(), [solid, size, uniform,
                                                       body](benchmark::State& state) {
      const Counted counted = make_counted(solid, size, uniform);
      TaskPool pool(1);
      pool.run([&] { body(state, counted); });
    })->Unit(benchmark::kMillisecond);
  };
  bench("plan_alone", [](benchmark::State& state, const Counted& counted) {
    for (auto _ : state) plan(counted, {});
  });
  bench("survey_block", [](benchmark::State& state, const Counted& counted) {
    std::size_t bytes = 0;
    for (auto _ : state) bytes = survey(counted, kBlocks / 2).size();
    const auto bricks = static_cast<double>(counted.block_bricks);
    state.counters["bytes/brick"] = static_cast<double>(bytes) / bricks;
    state.counters["bricks/s"] =
        benchmark::Counter(bricks, benchmark::Counter::kIsIterationInvariantRate);
  });
  bench("plan_from_blocks", [](benchmark::State& state, const Counted& counted) {
    std::vector<std::vector<std::byte>> blocks;
    for (std::size_t i = 0; i < kBlocks; ++i) blocks.push_back(survey(counted, i));
    const SurveyedBlocks surveyed{counted.block_bricks,
                                  [&](std::size_t i) { return std::optional(blocks[i]); }};
    for (auto _ : state) plan(counted, surveyed);
  });
}

}  // namespace
}  // namespace tet::bench

int main(int argc, char** argv) {
  using namespace tet::bench;
  for (const BenchSize& size : {kSmall, kLarge}) {
    for (const Solid solid : kSolids) {
      for (const bool uniform : {true, false}) add(solid, size, uniform);
    }
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
