// Kills a server and a worker at random moments while they do jobs, and holds what comes out
// against an undisturbed run.
//   job_kill_campaign --runs 200 [--seed 1]
// Each run prints its seed; --runs 1 --seed S does it again.
#include <algorithm>
#include <chrono>
#include <iostream>
#include <map>
#include <random>
#include <thread>

#include <CLI/CLI.hpp>
#include <absl/strings/str_cat.h>
#include <absl/time/clock.h>
#include <absl/time/time.h>

#include "tests/server/job_server.h"

namespace tet::test {
namespace {

constexpr int kRadii[] = {8, 16, 24};
/// So that the largest are counted in shards.
const std::vector<std::string> kOptions{"--job-count-bricks", "64"};
constexpr int kJobs = 3, kMostKills = 3, kMostMs = 700;

/// What came of all runs of a campaign.
struct Tally {
  int failed = 0, server_kills = 0, worker_kills = 0;
  absl::Duration slowest;  ///< from a run's last kill until all of its jobs were done
};

using Meshes = std::map<int, std::vector<std::string>>;  ///< by radius

/// What streams of the meshes send: their chunks, without header and trailer, which name the
/// grid file.
std::vector<std::string> chunks_of(std::vector<std::string> messages) {
  if (messages.size() < 2) return {};
  return {messages.begin() + 1, messages.end() - 1};
}

class Run {
 public:
  explicit Run(std::uint64_t seed) : random_(seed) {}

  /// What went wrong; empty if nothing.
  std::string play(const Meshes& undisturbed, Tally& tally) {
    server_.start(kOptions);
    auto worker = server_.start_worker(kOptions);
    for (int i = 0; i < kJobs; ++i) submit();
    const int kills = between(1, kMostKills);
    for (int i = 0; i < kills; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(between(0, kMostMs)));
      const int victim = between(0, 2);
      if (victim != 0) server_.start(kOptions);
      if (victim != 1) worker = server_.start_worker(kOptions);
      tally.server_kills += victim != 0 ? 1 : 0;
      tally.worker_kills += victim != 1 ? 1 : 0;
    }
    const absl::Time last_kill = absl::Now();
    for (const auto& [job, radius] : jobs_) server_.wait(job);
    tally.slowest = std::max(tally.slowest, absl::Now() - last_kill);
    for (const auto& [job, radius] : jobs_) {
      std::string wrong = check(job, undisturbed.at(radius));
      if (!wrong.empty()) return absl::StrCat(job.name(), ": ", wrong);
    }
    return "";
  }

 private:
  int between(int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(random_);
  }

  void submit() {
    const int radius = kRadii[between(0, std::ssize(kRadii) - 1)];
    v1::Job job = server_.ball(radius);
    job.set_skip_cache(between(0, 1) == 1);
    const v1::Job made = server_.create(job, absl::StrCat("job ", jobs_.size()));
    if (!server_.status.ok()) throw std::runtime_error(server_.status.error_message());
    jobs_.emplace_back(made, radius);
  }

  std::string check(const v1::Job& job, const std::vector<std::string>& mesh) {
    const v1::Job done = server_.wait(job);
    if (done.state() != v1::JOB_STATE_SUCCEEDED) return "it is " + done.ShortDebugString();
    if (done.determinism_alarms() != 0) return "it came with other bytes";
    const auto result = chunks_of(server_.result(job));
    if (!server_.status.ok()) return "its result: " + server_.status.error_message();
    if (result != mesh) return "its result is another";
    std::map<std::int64_t, int> counted, meshed;  // commits, by how many there were
    for (const v1::JobEvent& event : server_.watch(job, JobServer::is_finished)) {
      if (!JobServer::has_a_shard(event)) continue;
      const bool counting = event.progress().chunk_count() == 0;
      ++(counting ? counted : meshed)[event.progress().done_shards()];
    }
    for (const auto& commits : {counted, meshed}) {
      for (const auto& [shard, times] : commits) {
        if (times != 1)
          return absl::StrCat("shard ", shard, " was committed ", times, " times");
      }
    }
    if (std::ssize(meshed) != done.progress().shard_count()) return "shards are missing";
    return "";
  }

  std::mt19937_64 random_;
  JobServer server_{TETSTREAMD_PATH};
  std::vector<std::pair<v1::Job, int>> jobs_;
};

Meshes make_undisturbed() {
  JobServer server{TETSTREAMD_PATH};
  server.start({"--job-workers", "0"});
  Meshes meshes;
  for (const int radius : kRadii) {
    meshes[radius] = chunks_of(server.stream(server.ball(radius)));
  }
  return meshes;
}

}  // namespace

int campaign(std::uint64_t first_seed, int runs) {
  const Meshes undisturbed = make_undisturbed();
  Tally tally;
  for (int i = 0; i < runs; ++i) {
    const std::uint64_t seed = first_seed + static_cast<std::uint64_t>(i);
    const std::string wrong = Run(seed).play(undisturbed, tally);
    tally.failed += wrong.empty() ? 0 : 1;
    std::cout << "seed " << seed << ": " << (wrong.empty() ? "as it should be" : wrong)
              << std::endl;
  }
  std::cout << runs << " runs from seed " << first_seed << ", " << tally.failed << " failed; "
            << tally.server_kills << " kills of servers, " << tally.worker_kills
            << " of workers; all jobs done at most " << absl::FormatDuration(tally.slowest)
            << " after the last kill\n";
  return tally.failed == 0 ? 0 : 1;
}

}  // namespace tet::test

int main(int argc, char** argv) {
  CLI::App app("kills servers and workers that do jobs");
  std::uint64_t seed = 1;
  int runs = 1;
  app.add_option("--seed", seed, "of the first run; the next one has the next seed");
  app.add_option("--runs", runs, "how many");
  CLI11_PARSE(app, argc, argv);
  return tet::test::campaign(seed, runs);
}
