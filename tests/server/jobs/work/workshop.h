// Where jobs are done without a server: an engine, a store of jobs whose clock the test turns,
// and results.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <absl/status/status.h>
#include <absl/time/time.h>
#include <gtest/gtest.h>

#include "proto/wire/sha256.h"
#include "server/grids/grid_store.h"
#include "server/grids/grid_upload.h"
#include "server/jobs/results/job_spec.h"
#include "server/jobs/results/needed_meshes.h"
#include "server/jobs/results/result_store.h"
#include "server/jobs/store/sqlite_job_store.h"
#include "server/jobs/work/shard_maker.h"
#include "server/jobs/work/work_place.h"
#include "server/ops/logging.h"
#include "server/ops/memory.h"
#include "server/rpc/access.h"
#include "server/rpc/admission.h"
#include "server/rpc/calls.h"
#include "server/streams/mesh_engine.h"
#include "tests/server/test_folder.h"

namespace tet::test {

/// The uniform mesh of a unit ball with so many cells along its radius: about 50 cells^3 tets,
/// of 18 bytes each.
inline v1::MeshRequest ball_of(int cells) {
  v1::MeshRequest mesh;
  mesh.mutable_scene()->add_nodes()->mutable_sphere()->set_radius(1);
  mesh.set_spacing(1.0 / cells);
  mesh.set_levels(0);
  return mesh;
}

/// Results have a gibibyte unless `open_results` says otherwise. Nothing happens but what the
/// test has done, at the time that it says.
class Workshop {
 public:
  static constexpr std::uint64_t kPlenty = std::uint64_t{1} << 30;

  explicit Workshop(const Config& settings = {}) : config_(with_memory(settings)) {
    start_logging("off");
    open_results({.budget_bytes = kPlenty});
  }

  void open_results(const ResultStore::Limits& limits) {
    maker_.reset();
    results_ = ResultStore::open(folder_.path() / "results", limits, [this] {
                 return needed_results(*jobs_);
               }).value();
    maker_ = std::make_unique<ShardMaker>(engine_, *jobs_, *results_, place_);
  }

  /// The name of a stored file of these bytes.
  std::string store_grid(std::string_view bytes) {
    Sha256 digest;
    digest.add(bytes);
    const std::string name = digest.finish_hex();
    const auto upload = grids_->begin_upload({std::string(kDefaultSpace), name}, bytes.size());
    EXPECT_EQ((*upload)->append(0, bytes), absl::OkStatus());
    EXPECT_EQ((*upload)->commit(), absl::OkStatus());
    return name_of_grid(name);
  }

  /// Younger than those before it.
  Job create(const v1::MeshRequest& mesh, std::int64_t priority = 0) {
    turn_clock(absl::Milliseconds(1));
    stored::JobSpec spec;
    *spec.mutable_mesh() = mesh;
    NewJob job;
    job.space = kDefaultSpace;
    job.spec = spec.SerializeAsString();
    job.priority = priority;
    return jobs_->create(job).value().job;
  }
  Job get(const Job& job) { return jobs_->get(job.id).value(); }

  void turn_clock(absl::Duration time) { now_ += time; }

  std::vector<ShardLease> claim(std::int64_t most = 1) {
    return jobs_->claim({"w", most, absl::Hours(24)}).value();
  }
  absl::Status run(const ShardLease& lease) {
    return maker_->run(lease,
                       std::make_shared<PlanningWatch>(Cancellation::Clock::time_point::max()));
  }
  /// What a worker does with a shard that has found no room.
  void give_back_for_room(const ShardLease& lease, const absl::Status& why) {
    EXPECT_EQ(jobs_->release(lease.id, {why, absl::Seconds(2), true}), absl::OkStatus());
  }
  /// Does the next shard as a worker would. The test fails unless there is one.
  absl::Status do_next() {
    const auto leases = claim();
    EXPECT_EQ(leases.size(), 1U);
    if (leases.empty()) return absl::NotFoundError("no shard is ready");
    absl::Status done = run(leases[0]);
    if (ShardMaker::awaits_room(done)) give_back_for_room(leases[0], done);
    return done;
  }

  /// What the chunks of a mesh take, which is counted and not made.
  std::uint64_t bytes_of(const v1::MeshRequest& mesh) {
    const Job job = create(mesh);
    EXPECT_EQ(do_next(), absl::OkStatus());
    const auto plan = plan_of(get(job)).value();
    EXPECT_TRUE(jobs_->cancel(job.id).ok());
    return static_cast<std::uint64_t>(plan.header().mesh_bytes());
  }

  JobStore& jobs() { return *jobs_; }
  ShardMaker& maker() { return *maker_; }
  WorkPlace& place() { return place_; }
  ResultStore& results() { return *results_; }

 private:
  static Config with_memory(Config config) {
    config.threads = 2;
    EXPECT_EQ(divide_memory(config), absl::OkStatus());
    return config;
  }

  const TestFolder folder_;
  const Config config_;
  absl::Time now_ = absl::FromUnixSeconds(1'700'000'000);
  const std::unique_ptr<Access> access_ = Access::open("").value();
  const std::unique_ptr<GridStore> grids_ =
      GridStore::open(folder_.path() / "store", config_.store_bytes).value();
  Admission admission_{AdmissionLimits()};
  CallRegistry calls_{*access_, admission_};
  MeshEngine engine_{config_, calls_, *grids_};
  const std::unique_ptr<JobStore> jobs_ =
      open_sqlite_job_store({.path = folder_.file("jobs.db"), .clock = [this] { return now_; }})
          .value();
  WorkPlace place_{*jobs_, folder_.path() / "store", StoreUse::kOwn};
  std::unique_ptr<ResultStore> results_;
  std::unique_ptr<ShardMaker> maker_;
};

}  // namespace tet::test
