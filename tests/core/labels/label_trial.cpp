// label_trial: meshes hostile labels until so many tets have been made, and checks every
// promise of every mesh. Stops with exit code 1 at the first that is broken, and says how to
// see it again.
//   label_trial --tets 1e9 --seed 1 --bricks 3
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <random>
#include <string>

#include <CLI/CLI.hpp>

#include "core/base/parallel.h"
#include "core/mesh/quality.h"
#include "core/plan/labelled/label_plan.h"
#include "core/plan/make/fill_mesh.h"
#include "core/plan/mesh_request.h"
#include "tests/support/conformity.h"
#include "tests/support/label_sources.h"

namespace tet::test {
namespace {

struct Options {
  double tets = 1e8;
  std::uint32_t seed = 1;
  int bricks = 3;  ///< along an edge of the domain, at most
  int threads = 2;
};

/// One mesh to be made, and where its labels come from.
struct Trial {
  BrickBox domain;
  int levels = 0;
  CoordinateType coordinates = CoordinateType::kFloat64;
  std::uint32_t seed = 0;

  Trial(std::uint32_t of_seed, int bricks) : seed(of_seed) {
    std::mt19937 random(seed);
    const auto edge = [&] {
      return static_cast<int>(random() % static_cast<unsigned>(bricks));
    };
    const auto low = [&] { return static_cast<int>(random() % 5) - 2; };
    domain.min = {low(), low(), low()};
    domain.max = {domain.min.x + edge(), domain.min.y + edge(), domain.min.z + edge()};
    levels = random() % 2 == 0 ? 0 : kMaxLevels;
    coordinates = random() % 2 == 0 ? CoordinateType::kFloat64 : CoordinateType::kFloat32;
  }

  double volume() const {
    const auto edge = [](int min, int max) { return 8.0 * (max - min + 1); };
    return edge(domain.min.x, domain.max.x) * edge(domain.min.y, domain.max.y) *
           edge(domain.min.z, domain.max.z);
  }
};

absl::StatusOr<FilledMesh> make_mesh(const LabelCase& labels, const Trial& trial) {
  LabelJob job;
  job.source = std::make_shared<const FunctionLabels>(labels.functions);
  job.domain = trial.domain;
  job.labels.resize(labels.labels);
  job.request.levels = trial.levels;
  job.request.coordinates = trial.coordinates;
  const auto plan = plan_labels(job);
  if (!plan.ok()) return plan.status();
  return fill_mesh(**plan, Cancellation(), nullptr);
}

bool same_bytes(const TetMesh& a, const TetMesh& b) {
  return std::ranges::equal(a.positions.bytes(), b.positions.bytes()) &&
         std::ranges::equal(a.tets.bytes(), b.tets.bytes()) &&
         std::ranges::equal(a.regions.bytes(), b.regions.bytes());
}

/// The worst that was seen.
struct Seen {
  double tets = 0, least = 180, greatest = 0;
  std::uint64_t meshes = 0;
};

/// What is wrong with a mesh; nothing where nothing is.
std::string broken_promise(const LabelCase& labels,
                           const Trial& trial,
                           const TetMesh& mesh,
                           Seen& seen) {
  const ConformityReport report = check_conformity(mesh);
  if (!report.conforming()) return report.describe();
  const QualityStats measured = measure_quality(mesh);
  const AngleBounds bounds = angle_bounds(Preset::kBothSides, trial.coordinates);
  seen.least = std::min(seen.least, measured.min_dihedral_deg);
  seen.greatest = std::max(seen.greatest, measured.max_dihedral_deg);
  seen.tets += static_cast<double>(mesh.header.tet_count);
  ++seen.meshes;
  if (measured.min_dihedral_deg < bounds.min_deg ||
      measured.max_dihedral_deg > bounds.max_deg) {
    return "angles from " + std::to_string(measured.min_dihedral_deg) + " to " +
           std::to_string(measured.max_dihedral_deg);
  }
  constexpr double kRounding = 1e-3;  // of float32, per spacing of the box's faces
  if (labels.name.ends_with("surrounded") &&
      std::abs(measured.volume - trial.volume()) > kRounding * trial.volume()) {
    return "a volume of " + std::to_string(measured.volume);
  }
  return {};
}

/// All kinds of labels of one seed; false where a promise is broken.
bool run_trial(const Trial& trial, const Options& options, Seen& seen) {
  for (const LabelCase& labels : label_cases(trial.domain, trial.seed)) {
    const auto filled = make_mesh(labels, trial);
    std::string broken;
    if (!filled.ok()) {
      broken = filled.status().ToString();
    } else {
      broken = broken_promise(labels, trial, filled->mesh, seen);
      // Another order of tasks must give the same bytes.
      if (broken.empty() && trial.seed % 4 == 0) {
        const auto again = make_mesh(labels, trial);
        if (!again.ok() || !same_bytes(filled->mesh, again->mesh)) broken = "other bytes";
      }
    }
    if (broken.empty()) continue;
    const auto& [min, max] = trial.domain;
    std::printf("BROKEN: %s, bricks (%d, %d, %d) to (%d, %d, %d), levels %d: %s\n",
                labels.name.c_str(), min.x, min.y, min.z, max.x, max.y, max.z, trial.levels,
                broken.c_str());
    std::printf("to see it again: label_trial --tets 1 --seed %u --bricks %d\n", trial.seed,
                options.bricks);
    return false;
  }
  return true;
}

int run(const Options& options) {
  const WorkerThreads threads;
  TaskPool pool(options.threads);
  Seen seen;
  double next_line = 1;
  bool sound = true;
  for (std::uint32_t seed = options.seed; sound && seen.tets < options.tets; ++seed) {
    pool.run([&] { sound = run_trial(Trial(seed, options.bricks), options, seen); });
    if (seen.tets < next_line) continue;
    std::printf("seed %u: %llu meshes, %.4g tets, %.3f .. %.3f degrees\n", seed,
                static_cast<unsigned long long>(seen.meshes), seen.tets, seen.least,
                seen.greatest);
    std::fflush(stdout);
    next_line = std::max(2 * next_line, seen.tets);
  }
  std::printf("%s: %llu meshes, %.4g tets, %.3f .. %.3f degrees\n", sound ? "sound" : "BROKEN",
              static_cast<unsigned long long>(seen.meshes), seen.tets, seen.least,
              seen.greatest);
  return sound ? 0 : 1;
}

}  // namespace
}  // namespace tet::test

int main(int argc, char** argv) {
  CLI::App app("Checks what meshes of labels promise, on random and hostile labels.");
  tet::test::Options options;
  app.add_option("--tets", options.tets, "stop after so many")->capture_default_str();
  app.add_option("--seed", options.seed, "the first one")->capture_default_str();
  app.add_option("--bricks", options.bricks, "along an edge of the domain, at most")
      ->check(CLI::Range(1, 16))
      ->capture_default_str();
  app.add_option("--threads", options.threads, "worker threads")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  return tet::test::run(options);
}
