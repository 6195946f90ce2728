// Cancels plans at many moments, and tells how much processor time each took to stop.
//
//   cancel_trial [--moments N] [--max-milliseconds T] [--threads K]
//
// Moments are spread evenly over a plan, by processor time, so that what else runs on the
// machine changes nothing. Fails with exit code 1 when a plan took longer than T to stop.
#include <algorithm>
#include <ctime>
#include <iostream>
#include <memory>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <absl/strings/str_format.h>

#include "core/base/parallel.h"
#include "core/plan/make/plan_mesh.h"
#include "tests/support/solids.h"

namespace {

using namespace tet;

struct Options {
  int moments = 100;
  double max_milliseconds = 100;
  int threads = 2;
};

/// The processor time of this process, in milliseconds.
double processor_time() {
  timespec time{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

/// A plan that takes a second or so.
struct Case {
  const char* name;
  std::shared_ptr<const Volume> volume;
  MeshRequest request;
};

std::vector<Case> cases() {
  const auto ball = std::make_shared<const Volume>(test::ball(40));
  MeshRequest graded;
  graded.spacing = 1.0 / 6;
  MeshRequest uniform = graded;
  uniform.spacing = 1.0 / 3;
  uniform.levels = 0;
  MeshRequest improved = graded;
  improved.spacing = 1.0 / 1.5;
  improved.improve = true;
  MeshRequest manifold = graded;
  manifold.spacing = 1.0 / 4;
  manifold.manifold = true;
  MeshRequest both = graded;
  both.spacing = 1.0 / 4;
  both.preset = Preset::kBothSides;
  return {{"graded", ball, graded},
          {"uniform", ball, uniform},
          {"improved", ball, improved},
          {"manifold", ball, manifold},
          {"both sides", ball, both}};
}

/// Plans, and cancels once `after` milliseconds of processor time are used. The time it took to
/// stop; nothing if it was done before.
double time_to_stop(TaskPool& pool, const Case& planned, double after) {
  Cancellation cancellation;
  double cancelled_at = 0, stopped_at = 0;
  const double start = processor_time();
  std::jthread watcher([&](const std::stop_token& done) {
    while (!done.stop_requested() && processor_time() - start < after) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    cancelled_at = processor_time();
    cancellation.cancel();
  });
  pool.run([&] {
    const auto plan =
        plan_mesh({.shape = planned.volume, .request = planned.request}, cancellation);
    stopped_at = processor_time();
  });
  watcher.request_stop();
  watcher.join();
  return std::max(0.0, stopped_at - cancelled_at);
}

bool stops_in_time(TaskPool& pool, const Case& planned, const Options& options) {
  const double start = processor_time();
  time_to_stop(pool, planned, 1e9);
  const double whole = processor_time() - start;
  double longest = 0, worst = 0;
  for (int i = 0; i < options.moments; ++i) {
    const double after = whole * i / options.moments;
    const double took = time_to_stop(pool, planned, after);
    if (took > longest) worst = after;
    longest = std::max(longest, took);
  }
  std::cout << absl::StrFormat(
      "%-10s  takes %6.0f ms; stops within %5.1f ms, longest when cancelled after %.0f ms\n",
      planned.name, whole, longest, worst);
  return longest <= options.max_milliseconds;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Cancels plans at many moments");
  app.add_option("--moments", options.moments, "of each kind of plan")
      ->check(CLI::PositiveNumber);
  app.add_option("--max-milliseconds", options.max_milliseconds,
                 "of processor time that a plan may take to stop");
  app.add_option("--threads", options.threads, "that plans are made on");
  CLI11_PARSE(app, argc, argv);
  TaskPool pool(options.threads);
  bool all = true;
  for (const Case& planned : cases()) all &= stops_in_time(pool, planned, options);
  return all ? 0 : 1;
}
