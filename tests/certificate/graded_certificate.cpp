// Proves the dihedral angle bounds of graded surfaces, for every background tet and every edge
// of its nodes that random octrees have. docs/bounds.md tells the argument; it takes minutes.
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <iterator>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <absl/strings/str_format.h>

#include "tests/certificate/certify.h"
#include "tests/certificate/graded_cases.h"

namespace tet::certificate {
namespace {

struct Arguments {
  int trees = 20;
  bool cut = false;
  double least_deg = 0, greatest_deg = 0;  // unless asked for, the mesher's
  bool stored = false;
  unsigned threads = 2;
};

/// The signs of four nodes: as `++0-`, sorted.
std::string signs_of(std::size_t number) {
  std::array<int, 3> count{};
  for (std::size_t i = 0; i < 4; ++i, number /= 3) ++count[number % 3];
  return std::string(static_cast<std::size_t>(count[2]), '+') +
         std::string(static_cast<std::size_t>(count[1]), '0') +
         std::string(static_cast<std::size_t>(count[0]), '-');
}

/// What is proven of the tets with some signs.
struct Row {
  std::size_t problems = 0, boxes = 0;
  double least_deg = 180, greatest_deg = 0;
};

/// Proves one tet after another, with each of its signs; threads take turns.
class Prover {
 public:
  Prover(std::vector<test::PlacedTet> tets, const Arguments& arguments)
      : tets_(std::move(tets)), arguments_(arguments) {}

  void run() {
    const std::size_t all = tets_.size() * kStencilCases;
    for (std::size_t i = next_++; i < all; i = next_++) {
      prove(tets_[i / kStencilCases], i % kStencilCases);
    }
  }

  bool proven() const {
    return std::ranges::all_of(rows_, [&](const auto& row) {
      return row.second.least_deg >= arguments_.least_deg &&
             row.second.greatest_deg <= arguments_.greatest_deg;
    });
  }

  void print() const {
    absl::PrintF("signs      problems        boxes    least greatest\n");
    for (const auto& [signs, row] : rows_) {
      absl::PrintF("%-5s %13d %12d %8.3f %8.3f\n", signs, row.problems, row.boxes,
                   row.least_deg, row.greatest_deg);
    }
  }

 private:
  /// Many problems at a time: there are too many to keep.
  void prove(const test::PlacedTet& tet, std::size_t number) {
    constexpr std::size_t kBatch = 4096;
    std::vector<Problem> batch;
    for_each_graded_case(tet, number, kGradedLimits, [&](std::vector<Problem> problems) {
      std::ranges::move(problems, std::back_inserter(batch));
      if (batch.size() >= kBatch) settle(number, batch);
    });
    settle(number, batch);
  }

  void settle(std::size_t number, std::vector<Problem>& batch) {
    if (batch.empty()) return;
    const Certified least = certify(batch, goal(Extreme::kLeast));
    const Certified greatest = certify(batch, goal(Extreme::kGreatest));
    const std::lock_guard lock(mutex_);
    Row& row = rows_[signs_of(number)];
    row.problems += batch.size();
    row.boxes += least.boxes + greatest.boxes;
    row.least_deg = std::min(row.least_deg, least.bound_deg);
    row.greatest_deg = std::max(row.greatest_deg, greatest.bound_deg);
    batch.clear();
  }

  Goal goal(Extreme extreme) const {
    Goal goal;
    goal.extreme = extreme;
    goal.enough_deg =
        extreme == Extreme::kLeast ? arguments_.least_deg : arguments_.greatest_deg;
    goal.refute = false;
    if (arguments_.stored) goal.displacement = kStoredDisplacement;
    return goal;
  }

  const std::vector<test::PlacedTet> tets_;
  const Arguments& arguments_;
  std::atomic<std::size_t> next_ = 0;
  std::mutex mutex_;  // the rows
  std::map<std::string, Row> rows_;
};

int run(Arguments arguments) {
  if (arguments.least_deg == 0)
    arguments.least_deg = arguments.cut ? kLeastCutAngleDeg : kLeastGradedAngleDeg;
  if (arguments.greatest_deg == 0)
    arguments.greatest_deg = arguments.cut ? kGreatestCutAngleDeg : kGreatestGradedAngleDeg;
  Prover prover(test::placed_tets(arguments.trees, arguments.cut), arguments);
  const auto start = std::chrono::steady_clock::now();
  std::vector<std::jthread> threads;
  for (unsigned t = 1; t < arguments.threads; ++t) threads.emplace_back([&] { prover.run(); });
  prover.run();
  threads.clear();
  prover.print();
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  absl::PrintF("%s: %g .. %g degrees%s, in %.0f s\n", prover.proven() ? "proven" : "NOT PROVEN",
               arguments.least_deg, arguments.greatest_deg,
               arguments.stored ? " as float32" : "", taken.count());
  return prover.proven() ? 0 : 1;
}

}  // namespace
}  // namespace tet::certificate

int main(int argc, char** argv) {
  CLI::App app("Proves, in interval arithmetic, the dihedral angle bounds of graded surfaces.");
  tet::certificate::Arguments arguments;
  app.add_option("--trees", arguments.trees, "Random octrees whose tets are proven")
      ->capture_default_str();
  app.add_option("--least", arguments.least_deg,
                 "The bound to prove of the least angle, degrees [the mesher's]");
  app.add_option("--greatest", arguments.greatest_deg, "The same of the greatest angle");
  app.add_flag("--cut", arguments.cut, "Of meshes that a box cuts, too");
  app.add_flag("--stored", arguments.stored, "Of positions stored as float32");
  app.add_option("--threads", arguments.threads, "The results are the same")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  return tet::certificate::run(arguments);
}
