// graded_limits: the worst dihedral angles that warp limits of graded surfaces allow, by an
// adversarial search over every tet of their backgrounds; and better limits, by trial. How the
// limits of core/graded/graded_warp.h were found.
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <mutex>
#include <numeric>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>

#include "tests/core/graded/background_places.h"
#include "tests/core/graded/worst_angles.h"

namespace tet::test {
namespace {

struct Options {
  int trees = 20;
  std::vector<double> alpha;
  double climb_seconds = 0;
  bool cut = false;
  std::uint32_t seed = 1;
  unsigned threads = std::max(1U, std::thread::hardware_concurrency());
};

/// The members of GradedLimits, in their order.
constexpr std::array kMembers{
    &GradedLimits::corner_to_corner,      &GradedLimits::corner_to_far_corner,
    &GradedLimits::corner_across_face,    &GradedLimits::corner_to_centre,
    &GradedLimits::corner_to_far_centre,  &GradedLimits::face_centre_to_centre,
    &GradedLimits::edge_middle_to_centre, &GradedLimits::centre_to_centre,
    &GradedLimits::centre_to_corner,      &GradedLimits::centre_to_face_centre,
    &GradedLimits::centre_to_edge_middle, &GradedLimits::across_cut_face,
};

GradedLimits as_limits(const std::vector<double>& list) {
  GradedLimits limits;
  for (std::size_t i = 0; i < kMembers.size(); ++i) limits.*kMembers[i] = list[i];
  return limits;
}

/// Tries limits on all tets; those that were worst come first, so that poor limits end early.
class Judge {
 public:
  Judge(std::vector<PlacedTet> tets, unsigned threads)
      : tets_(std::move(tets)),
        threads_(threads),
        order_(tets_.size()),
        last_(tets_.size(), 180) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
  }

  /// Below `enough_deg` it is only known that it is.
  WorstAngles worst(const GradedLimits& limits, double enough_deg) {
    std::ranges::sort(order_, {}, [&](std::size_t i) { return last_[i]; });
    std::atomic<std::size_t> next = 0;
    std::atomic<bool> poor = false;
    std::mutex mutex;
    WorstAngles all;
    const auto work = [&] {
      for (std::size_t i = next++; i < order_.size() && !poor; i = next++) {
        const WorstAngles one = worst_angles(tets_[order_[i]], limits, enough_deg);
        const std::lock_guard lock(mutex);
        last_[order_[i]] = one.min_deg;
        if (one.min_deg < all.min_deg) {
          all.min_deg = one.min_deg;
          all.min_signs = one.min_signs;
        }
        all.max_deg = std::max(all.max_deg, one.max_deg);
        if (one.min_deg < enough_deg) poor = true;
      }
    };
    std::vector<std::jthread> threads;
    for (unsigned t = 1; t < threads_; ++t) threads.emplace_back(work);
    work();
    threads.clear();
    return all;
  }

  std::size_t size() const { return tets_.size(); }
  /// What each tet's worst angle was last.
  void print_all() const {
    for (const std::size_t i : order_) {
      std::printf("  %8.3f ", last_[i]);
      for (const PlacedNode& node : tets_[i]) {
        std::printf(" (%d %d %d)/%d:%zu", node.at.x, node.at.y, node.at.z, node.level,
                    node.edges.size());
      }
      std::printf("\n");
    }
  }

 private:
  std::vector<PlacedTet> tets_;
  unsigned threads_;
  std::vector<std::size_t> order_;
  std::vector<double> last_;
};

void print(const GradedLimits& limits, const WorstAngles& worst) {
  for (const auto member : kMembers) std::printf("%.3f ", limits.*member);
  std::printf("  %.3f (%s) to %.3f degrees\n", worst.min_deg, worst.min_signs.c_str(),
              worst.max_deg);
  std::fflush(stdout);
}

double seconds_now() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration<double>(now).count();
}

/// Changes one or two of them at a time, and keeps what is better.
void climb(const Options& options, Judge& judge, GradedLimits limits, double best) {
  std::mt19937 random(options.seed);
  std::normal_distribution<double> normal;
  const double start = seconds_now();
  double step = 0.05;
  while (seconds_now() - start < options.climb_seconds) {
    GradedLimits tried = limits;
    const int changes = 1 + static_cast<int>(random() % 3);
    for (int i = 0; i < changes; ++i) {
      double& alpha = tried.*kMembers[random() % kMembers.size()];
      alpha = std::clamp(alpha + step * normal(random), 0.02, 0.49);
    }
    const WorstAngles worst = judge.worst(tried, best + 0.005);
    if (worst.min_deg >= best + 0.005) {
      limits = tried;
      best = worst.min_deg;
      print(limits, worst);
    }
    step = std::max(0.01, 0.995 * step);
  }
}

int run(const Options& options) {
  Judge judge(placed_tets(options.trees, options.cut), options.threads);
  std::printf("%zu tets that differ\n", judge.size());
  const GradedLimits limits = options.alpha.empty() ? kGradedLimits : as_limits(options.alpha);
  const double start = seconds_now();
  const WorstAngles worst = judge.worst(limits, 0);
  print(limits, worst);
  judge.print_all();
  std::printf("%.1f s\n", seconds_now() - start);
  if (options.climb_seconds > 0) climb(options, judge, limits, worst.min_deg);
  return worst.min_deg >= (options.cut ? kLeastCutAngleDeg : kLeastGradedAngleDeg) ? 0 : 1;
}

}  // namespace
}  // namespace tet::test

int main(int argc, char** argv) {
  using tet::test::Options;
  CLI::App app("The worst dihedral angles that warp limits of graded surfaces allow.");
  Options options;
  app.add_option("--trees", options.trees, "Random octrees whose tets are tried")
      ->capture_default_str();
  app.add_option("--alpha", options.alpha,
                 "Other limits, in the order of GradedLimits [the mesher's]")
      ->expected(static_cast<int>(tet::test::kMembers.size()));
  app.add_option("--climb", options.climb_seconds, "Seconds to look for better limits");
  app.add_flag("--cut", options.cut, "Some of them end at a box");
  app.add_option("--seed", options.seed, "Of that")->capture_default_str();
  app.add_option("--threads", options.threads)->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  return tet::test::run(options);
}
