// From a valid order to a counted mesh: find the file, load the grid, load the grids of its
// sizing and of its fields if there are any, plan; each step once. A scene has any number of
// grids, and so has an order for several.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/plan/mesh_plan.h"
#include "core/plan/mesh_progress.h"
#include "core/plan/surveyed_blocks.h"
#include "core/vdb/decoder/decoder_pool.h"
#include "proto/convert/request.h"
#include "server/grids/grid_store.h"
#include "server/grids/volume_cache.h"
#include "server/meshing/plan_cache.h"
#include "server/meshing/plan_turns.h"

namespace tet {

/// What a mesh is planned from, in memory.
struct PlanInput {
  Shape shape;
  MeshRequest request;                ///< with the grids of its sizing and its fields
  std::vector<GridLease> grids = {};  ///< keep the files from being evicted
};

/// A counted mesh and its names.
struct PlannedMesh {
  std::shared_ptr<const MeshPlan> plan;
  v1::MeshRequest canonical;
  std::string mesh_id;
  std::vector<GridLease> grids;  ///< keep the files from being evicted
};

/// What a caller of the planner shares with the work done for it; outlives both by shared_ptr.
struct PlanningWatch {
  explicit PlanningWatch(Cancellation::Clock::time_point deadline) : cancellation(deadline) {}
  Cancellation cancellation;
  MeshProgress progress;
};

/// What a planner keeps, and how often a plan that was asked for was there.
struct PlannerStats {
  CacheStats volumes;
  std::uint64_t hits = 0, misses = 0;
  std::uint64_t plan_bytes = 0, plan_budget_bytes = 0;  ///< of plans held or in use
};

/// What need not be surveyed again.
struct SurveyedBefore {
  SurveyedBlocks blocks = {};
  /// The plan of what may be alike in part. Whoever plans holds it for as long as it is to be
  /// used, and can let go of it where there is no room for both.
  std::weak_ptr<const MeshPlan> earlier = {};
  /// See PlanJob::replaced.
  std::shared_ptr<const std::vector<BrickCoord>> replaced = nullptr;
};

/// How much a planner may keep, bytes.
struct PlannerMemory {
  std::uint64_t volume_bytes = 0;
  std::uint64_t plan_bytes = 0;
};

/// The threads that plans are made on.
struct PlannerThreads {
  FairTasks& tasks;   ///< what comes before planning
  LargePlans& loads;  ///< what takes as long as a file is large
  PlanTurns& turns;
};

/// Plans meshes and remembers the last few, so that a resumed stream starts at once.
///
/// What it does for a client it does in that client's turns, from the first step on.
///
/// Thread safety: any thread may call any member. The pools are not used before the first
/// `plan`; their tasks must have ended before the planner is destroyed.
class Planner {
 public:
  using Done = std::function<void(absl::StatusOr<PlannedMesh>)>;
  using Loaded = std::function<void(absl::StatusOr<PlanInput>)>;

  Planner(const PlannerThreads& threads,
          DecoderPool& decoders,
          GridStore& store,
          const PlannerMemory& memory,
          MeshLimits limits);

  /// Calls `done` on one of the threads. What was surveyed before, for an earlier plan or by
  /// other hosts, is taken if the plan is not at hand. Errors: those of `load` and plan_mesh.
  void plan(const std::string& client,
            MeshOrder order,
            std::shared_ptr<PlanningWatch> watch,
            Done done,
            SurveyedBefore before = {});

  /// Only loads what it would be planned from. Calls `done` on one of the threads. Errors:
  /// those of GridStore::acquire, DecoderPool::decode and volume_of.
  void load(const std::string& client,
            MeshOrder order,
            std::shared_ptr<PlanningWatch> watch,
            Loaded done);

  /// Counts memory for work on a plan with that of plans. Errors: those of PlanCache::reserve.
  absl::StatusOr<std::shared_ptr<const void>> reserve(std::uint64_t bytes,
                                                      std::string_view what) {
    return plans_.reserve(bytes, what);
  }

  /// The limits that hold for each mesh.
  const MeshLimits& limits() const noexcept { return limits_; }

  /// Plans being made now.
  int running() const noexcept { return running_.load(); }
  PlannerStats stats() const;
  /// Whether a grid or a plan was refused since `then`, as others in use left no room for it.
  bool has_refused_since(LastTime::Clock::time_point then) const noexcept {
    return volumes_.has_refused_since(then) || plans_.has_refused_since(then);
  }

 private:
  /// A mesh to be planned, or only loaded.
  struct Job {
    std::string client;
    MeshOrder order;
    std::shared_ptr<PlanningWatch> watch;
    std::function<void(Job, const absl::Status& loaded)> then;  ///< in one of its tasks
    std::vector<GridLease> grids = {};
    Shape shape = {};
    GridList several = {};  ///< loaded so far, of as many as the order names
    std::size_t field = 0;  ///< of the request's, that is loaded next

    PlannedMesh planned(std::shared_ptr<const MeshPlan> plan) const;
    /// Ends it, in one of its tasks: what `key` names cannot be had.
    void fail(const VolumeKey& key, const absl::Status& status) const;
    /// Takes a step of it; what that throws ends it.
    void guard(const std::function<void()>& step) const;
  };

  /// In one of the job's tasks: the job, with what was loaded.
  using GridLoaded = std::function<void(Job, GridLease, std::shared_ptr<const Volume>)>;
  using AnyLoaded = std::function<void(Job, GridLease, const GridInMemory&)>;

  void post(Job job, void (Planner::*step)(Job));
  void load_shape(Job job);
  void load_several(Job job);
  void load_labels(Job job);
  void load_grid(Job job, const VolumeKey& key, GridLoaded then);
  void load_any(Job job, const VolumeKey& key, AnyLoaded then);
  void load_scene(Job job);
  void make_scene(Job job);
  void load_sizes(Job job);
  void load_fields(Job job);
  /// What a turn came to.
  struct Attempt {
    absl::StatusOr<std::shared_ptr<const MeshPlan>> plan;
    bool is_cut_short = false;  ///< it takes a longer turn; `plan` says nothing
  };

  void plan_loaded(const Job& job, const SurveyedBefore& before, const Done& done);
  Attempt make_plan(const Job& job,
                    const std::string& name,
                    const SurveyedBefore& before,
                    const PlanTurn& turn);
  Attempt plan_in_turn(const Job& job,
                       const SurveyedBefore& before,
                       const PlanTurn& turn) const;

  const PlannerThreads threads_;
  GridStore& store_;
  const MeshLimits limits_;
  PlanCache plans_;  ///< the volumes let go of it
  VolumeCache volumes_;
  std::atomic<int> running_{0};
  std::atomic<std::uint64_t> hits_{0}, misses_{0};
};

}  // namespace tet
