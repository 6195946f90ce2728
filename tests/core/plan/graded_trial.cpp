// graded_trial: meshes random fields and scenes with graded surfaces until so many tets have
// been made, and checks every promise of every mesh. Stops with exit code 1 at the first that
// is broken, and says how to see it again.
#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>

#include "tests/support/campaign.h"
#include "tests/support/graded_promises.h"
#include "tests/support/random_fields.h"

namespace tet::test {
namespace {

struct Options {
  double tets = 1e8;
  std::uint64_t inputs = UINT64_MAX;
  std::uint32_t seed = 1;
  int edge = 64;
  std::string family = "all";
  unsigned threads = std::max(1U, std::thread::hardware_concurrency());
};

std::vector<std::string> all_families() {
  std::vector<std::string> families(field_families().begin(), field_families().end());
  families.emplace_back("scene");
  return families;
}

/// What all threads have done so far.
class Trial {
 public:
  explicit Trial(const Options& options) : options_(options) {
    if (options.family != "all") families_ = {options.family};
  }

  /// False once there have been enough.
  bool try_input(std::uint64_t i, TaskPool& pool) {
    const GradedCase graded_case{
        families_[i % families_.size()],
        options_.seed + static_cast<std::uint32_t>(i / families_.size()), options_.edge};
    report(graded_case, check_graded_promises(graded_case, pool));
    return !failed_ && static_cast<double>(tets_) < options_.tets;
  }

  bool failed() const { return failed_; }

  void print_summary() const {
    for (const auto& [family, worst] : worst_) {
      std::printf("%-12s %12llu tets, %.3f to %.3f degrees\n", family.c_str(),
                  static_cast<unsigned long long>(worst.tets), worst.min_dihedral_deg,
                  worst.max_dihedral_deg);
    }
    std::printf("%.4g tets: %s\n", static_cast<double>(tets_),
                failed_ ? "a promise is broken" : "every promise kept");
  }

 private:
  void report(const GradedCase& graded_case, const Outcome& outcome) {
    const std::lock_guard lock(mutex_);
    tets_ += outcome.tets;
    Outcome& worst = worst_[graded_case.family];
    worst.tets += outcome.tets;
    worst.min_dihedral_deg = std::min(worst.min_dihedral_deg, outcome.min_dihedral_deg);
    worst.max_dihedral_deg = std::max(worst.max_dihedral_deg, outcome.max_dihedral_deg);
    if (outcome.violation.empty()) return;
    failed_ = true;
    std::printf("BROKEN: %s\nto see it again: graded_trial --inputs 1 %s\n",
                outcome.violation.c_str(), arguments_of(graded_case).c_str());
    std::fflush(stdout);
  }

  const Options options_;
  std::vector<std::string> families_ = all_families();
  std::atomic<std::uint64_t> tets_{0};
  std::atomic<bool> failed_{false};
  std::mutex mutex_;  // below and the output
  std::map<std::string, Outcome> worst_;
};

int run(const Options& options) {
  Trial trial(options);
  try_inputs(options.threads, options.inputs,
             [&](std::uint64_t i, TaskPool& pool) { return trial.try_input(i, pool); });
  trial.print_summary();
  return trial.failed() ? 1 : 0;
}

}  // namespace
}  // namespace tet::test

int main(int argc, char** argv) {
  using tet::test::Options;
  CLI::App app(
      "Meshes random inputs with graded surfaces and checks every promise of their meshes.");
  Options options;
  std::vector<std::string> families = tet::test::all_families();
  families.emplace_back("all");
  app.add_option("--tets", options.tets, "Stop after so many tets")->capture_default_str();
  app.add_option("--inputs", options.inputs, "Stop after so many inputs");
  app.add_option("--seed", options.seed, "Of the first input")->capture_default_str();
  app.add_option("--edge", options.edge, "Of an input, voxels")
      ->capture_default_str()
      ->check(CLI::Range(4, 1024));
  app.add_option("--family", options.family)->check(CLI::IsMember(families));
  app.add_option("--threads", options.threads, "Inputs tried at once")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);
  return tet::test::run(options);
}
