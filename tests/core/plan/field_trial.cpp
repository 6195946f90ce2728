// field_trial: meshes random fields until so many tets have been made, and checks every promise
// of every mesh. Stops with exit code 1 at the first that is broken, and says how to see it
// again.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>

#include "tests/support/campaign.h"
#include "tests/support/mesh_promises.h"
#include "tests/support/random_fields.h"

namespace tet::test {
namespace {

struct Options {
  double tets = 1e8;
  std::uint64_t fields = UINT64_MAX;
  std::uint32_t seed = 1;
  int edge = 64;
  double spacing = 0;  // 0: by seed
  std::string family = "all", preset = "all";
  unsigned threads = std::max(1U, std::thread::hardware_concurrency());
};

std::vector<std::string> families_of(const Options& options) {
  if (options.family != "all") return {options.family};
  return {field_families().begin(), field_families().end()};
}

std::vector<Preset> presets_of(const Options& options) {
  if (options.preset == "all") return {kPresets.begin(), kPresets.end()};
  return {*parse_preset(options.preset)};
}

/// Families take turns, then presets, then seeds.
class Cases {
 public:
  explicit Cases(const Options& options)
      : options_(options), families_(families_of(options)), presets_(presets_of(options)) {}

  FieldCase at(std::uint64_t i) const {
    const std::uint64_t turn = i / families_.size();
    FieldCase field_case;
    field_case.family = families_[i % families_.size()];
    field_case.preset = presets_[turn % presets_.size()];
    field_case.seed = options_.seed + static_cast<std::uint32_t>(turn / presets_.size());
    field_case.spacing = options_.spacing > 0 ? options_.spacing : spacing_of(field_case.seed);
    field_case.edge = options_.edge;
    // The edge is chosen so that there are as many tets as on the voxels.
    if (options_.spacing == 0) field_case.edge = edge_of(field_case.spacing);
    return field_case;
  }

 private:
  /// Two of 16 seeds take a lattice that is not the voxels': its samples take long.
  static double spacing_of(std::uint32_t seed) {
    return seed % 16 == 3 ? 0.7 : seed % 16 == 11 ? 1.4 : 1;
  }
  int edge_of(double spacing) const {
    return std::max(4, static_cast<int>(options_.edge * spacing));
  }

  Options options_;
  std::vector<std::string> families_;
  std::vector<Preset> presets_;
};

/// What all threads have done so far.
class Trial {
 public:
  explicit Trial(const Options& options) : options_(options), cases_(options) {}

  /// False once there have been enough.
  bool try_input(std::uint64_t i, TaskPool& pool) {
    const FieldCase field_case = cases_.at(i);
    report(field_case, check_promises(field_case, pool));
    return !failed_ && static_cast<double>(tets_) < options_.tets;
  }

  bool failed() const { return failed_; }

  void print_summary() const {
    std::printf("%llu fields, %.4g tets in %.1f s (%.3g tets/s): %s\n",
                static_cast<unsigned long long>(fields_), static_cast<double>(tets_), seconds(),
                static_cast<double>(tets_) / seconds(),
                failed_ ? "a promise is broken" : "every promise kept");
  }

 private:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

  void report(const FieldCase& field_case, const Outcome& outcome) {
    const std::lock_guard lock(mutex_);
    tets_ += outcome.tets;
    ++fields_;
    std::printf("%s: %llu tets, %.2f to %.2f degrees; %.4g tets, %.3g/s\n",
                arguments_of(field_case).c_str(), static_cast<unsigned long long>(outcome.tets),
                outcome.min_dihedral_deg, outcome.max_dihedral_deg, static_cast<double>(tets_),
                static_cast<double>(tets_) / seconds());
    if (!outcome.violation.empty()) {
      failed_ = true;
      std::printf("BROKEN: %s\nto see it again: field_trial --fields 1 %s\n",
                  outcome.violation.c_str(), arguments_of(field_case).c_str());
    }
    std::fflush(stdout);
  }

  const Options options_;
  const Cases cases_;
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::atomic<std::uint64_t> tets_{0};
  std::atomic<bool> failed_{false};
  std::mutex mutex_;  // below and the output
  std::uint64_t fields_ = 0;
};

void describe_options(CLI::App& app, Options& options) {
  std::vector<std::string> families{"all"}, presets{"all"};
  for (const std::string_view family : field_families()) families.emplace_back(family);
  for (const Preset preset : kPresets) presets.emplace_back(preset_name(preset));
  app.add_option("--tets", options.tets, "Stop after so many tets")->capture_default_str();
  app.add_option("--fields", options.fields, "Stop after so many fields");
  app.add_option("--seed", options.seed, "Of the first field")->capture_default_str();
  app.add_option("--edge", options.edge, "Of a field, voxels")
      ->capture_default_str()
      ->check(CLI::Range(4, 1024));
  app.add_option("--spacing", options.spacing, "Voxels; 0 varies it")->capture_default_str();
  app.add_option("--family", options.family)->check(CLI::IsMember(families));
  app.add_option("--preset,--presets", options.preset)->check(CLI::IsMember(presets));
  app.add_option("--threads", options.threads, "Fields tried at once")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
}

int run(const Options& options) {
  Trial trial(options);
  try_inputs(options.threads, options.fields,
             [&](std::uint64_t i, TaskPool& pool) { return trial.try_input(i, pool); });
  trial.print_summary();
  return trial.failed() ? 1 : 0;
}

}  // namespace
}  // namespace tet::test

int main(int argc, char** argv) {
  CLI::App app("Meshes random fields and checks every promise of their meshes.");
  tet::test::Options options;
  tet::test::describe_options(app, options);
  CLI11_PARSE(app, argc, argv);
  return tet::test::run(options);
}
