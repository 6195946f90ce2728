// Proves the dihedral angle bounds of the presets. docs/bounds.md tells the argument.
#include <atomic>
#include <chrono>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <absl/strings/str_format.h>

#include "core/labels/label_cost.h"
#include "core/plan/mesh_request.h"
#include "tests/certificate/background_cases.h"
#include "tests/certificate/certify.h"
#include "tests/certificate/label_cases.h"
#include "tests/certificate/stuffing_cases.h"

namespace tet::certificate {
namespace {

struct Arguments {
  std::string preset = "all";
  float alpha_long = 0, alpha_short = 0;
  bool both_sides = false;
  bool full = false;
  double tolerance_deg = 0.005;
  unsigned threads = 2;

  bool alphas_given() const { return alpha_long > 0; }
};

/// The proofs of one kind of tets: both ends, exact and stored.
struct Row {
  std::string name;
  std::vector<Problem> problems;
  std::array<Certified, 4> proven;  ///< least, greatest; then the same of float32 positions
  double seconds = 0;

  std::size_t boxes() const {
    std::size_t sum = 0;
    for (const Certified& one : proven) sum += one.boxes;
    return sum;
  }
  std::size_t parameters() const {
    std::size_t most = 0;
    for (const Problem& problem : problems) most = std::max(most, problem.parameter_count);
    return most;
  }
};

/// Some rules, and what its angles are said to lie between.
struct Claim {
  std::string name;
  StuffingRules rules;
  AngleBounds exact, stored;
};

std::vector<Row> rows_of(const StuffingRules& rules) {
  std::map<std::string, std::vector<Problem>> by_name;
  for (Problem& problem : stuffing_cases(rules)) {
    by_name[problem.name].push_back(std::move(problem));
  }
  if (rules.both_sides) {  // and any number of labels
    for (Problem& problem : label_cases(rules.limits)) {
      by_name[problem.name].push_back(std::move(problem));
    }
  }
  by_name["background"] = background_cases();
  std::vector<Row> rows;
  rows.reserve(by_name.size());
  for (auto& [name, problems] : by_name) rows.push_back({name, std::move(problems), {}});
  return rows;
}

Goal goal_of(const Claim& claim, const Arguments& arguments, std::size_t which) {
  Goal goal;
  goal.extreme = which % 2 == 0 ? Extreme::kLeast : Extreme::kGreatest;
  if (which >= 2) goal.displacement = kStoredDisplacement;
  const AngleBounds& bounds = which >= 2 ? claim.stored : claim.exact;
  if (!arguments.full) goal.enough_deg = which % 2 == 0 ? bounds.min_deg : bounds.max_deg;
  goal.refute = false;
  goal.tolerance_deg = arguments.tolerance_deg;
  return goal;
}

double seconds_now() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration<double>(now).count();
}

/// Rows are proven side by side; none depends on another.
void prove(const Claim& claim, const Arguments& arguments, std::vector<Row>& rows) {
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < rows.size(); i = next++) {
      const double start = seconds_now();
      for (std::size_t which = 0; which < 4; ++which) {
        rows[i].proven[which] = certify(rows[i].problems, goal_of(claim, arguments, which));
      }
      rows[i].seconds = seconds_now() - start;
    }
  };
  std::vector<std::jthread> threads;
  for (unsigned t = 1; t < arguments.threads; ++t) threads.emplace_back(work);
  work();
}

bool within(const Row& row, const Claim& claim) {
  const auto& [least, greatest, stored_least, stored_greatest] = row.proven;
  return least.bound_deg >= claim.exact.min_deg && greatest.bound_deg <= claim.exact.max_deg &&
         stored_least.bound_deg >= claim.stored.min_deg &&
         stored_greatest.bound_deg <= claim.stored.max_deg;
}

void print(const Row& row) {
  const auto& [least, greatest, stored_least, stored_greatest] = row.proven;
  absl::PrintF("%-14s %5d %6d   %8.3f %8.3f   %8.3f %8.3f   %9d %7.2f\n", row.name,
               row.problems.size(), row.parameters(), least.bound_deg, greatest.bound_deg,
               stored_least.bound_deg, stored_greatest.bound_deg, row.boxes(), row.seconds);
}

/// Proves what float32 makes of tets that are taken only where they are good, as they are
/// computed.
bool prove_good(const Claim& claim) {
  const double turn = greatest_turn_deg(kLeastWidth, kStoredDisplacement);
  absl::PrintF("%-14s                %8.3f %8.3f   %8.3f %8.3f\n", "where good", kGoodLeast,
               kGoodGreatest, kGoodLeast - turn, kGoodGreatest + turn);
  return kGoodLeast - turn >= claim.stored.min_deg &&
         kGoodGreatest + turn <= claim.stored.max_deg;
}

/// Proves and prints; false where some bound is worse than claimed.
bool prove_claim(const Claim& claim, const Arguments& arguments) {
  absl::PrintF(
      "%s: alpha_long %g, alpha_short %g\n"
      "                                 exact positions     stored as float32\n"
      "signs           tets params      least greatest      least greatest       boxes "
      "seconds\n",
      claim.name, claim.rules.limits.alpha_long, claim.rules.limits.alpha_short);
  std::vector<Row> rows = rows_of(claim.rules);
  prove(claim, arguments, rows);
  bool proven = true;
  for (const Row& row : rows) {
    print(row);
    proven = proven && within(row, claim);
  }
  if (claim.rules.both_sides && !arguments.alphas_given()) {
    proven = prove_good(claim) && proven;
  }
  absl::PrintF("%s: %.4g .. %.5g degrees, as float32 %.4g .. %.5g\n\n",
               proven ? "proven" : "NOT PROVEN", claim.exact.min_deg, claim.exact.max_deg,
               claim.stored.min_deg, claim.stored.max_deg);
  return proven;
}

std::vector<Claim> claims_of(const Arguments& arguments) {
  if (arguments.alphas_given()) {
    return {{"given limits", {arguments.alpha_long, arguments.alpha_short}, {}, {}}};
  }
  std::vector<Claim> claims;
  for (const Preset preset : {Preset::kDefault, Preset::kMinAngle, Preset::kBothSides}) {
    const std::string name(preset_name(preset));
    if (arguments.preset != "all" && arguments.preset != name) continue;
    claims.push_back({name, stuffing_rules(preset),
                      angle_bounds(preset, CoordinateType::kFloat64),
                      angle_bounds(preset, CoordinateType::kFloat32)});
  }
  return claims;
}

}  // namespace

static int run(int argc, char** argv) {
  CLI::App app(
      "Proves, in interval arithmetic, what the dihedral angles of all tets lie between.\n"
      "Prints the proven bounds by the signs of the lattice tet, in degrees. Exit code 0: the\n"
      "published bounds are proven; 1: they are not.");
  Arguments arguments;
  app.add_option("--preset", arguments.preset, "which one")
      ->check(CLI::IsMember({"default", "min-angle", "both-sides", "all"}))
      ->capture_default_str();
  auto* alpha_long =
      app.add_option("--alpha-long", arguments.alpha_long, "other warp limits than a preset's")
          ->check(CLI::Range(0.01, 0.49));
  app.add_option("--alpha-short", arguments.alpha_short, "the same, on short edges")
      ->check(CLI::Range(0.01, 0.49))
      ->needs(alpha_long);
  app.add_flag("--both-sides", arguments.both_sides, "the same, mesh the outside too")
      ->needs(alpha_long);
  app.add_flag("--full", arguments.full,
               "find each kind's own bounds; else those that are published are proven of it");
  app.add_option("--tolerance", arguments.tolerance_deg,
                 "with --full: degrees between a bound and the worst angle seen")
      ->check(CLI::Range(1e-3, 10.0))
      ->capture_default_str();
  app.add_option("--threads", arguments.threads, "worker threads; the results are the same")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  if (arguments.alphas_given()) arguments.full = true;
  if (arguments.alpha_short == 0) arguments.alpha_short = arguments.alpha_long;
  bool proven = true;
  for (const Claim& claim : claims_of(arguments)) {
    proven = prove_claim(claim, arguments) && proven;
  }
  return proven ? 0 : 1;
}

}  // namespace tet::certificate

int main(int argc, char** argv) { return tet::certificate::run(argc, argv); }
