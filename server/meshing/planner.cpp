#include "server/meshing/planner.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <utility>

#include <absl/strings/str_cat.h>

#include "core/base/on_cancel.h"
#include "core/base/thread_time.h"
#include "core/plan/make/plan_mesh.h"
#include "core/plan/plan_price.h"
#include "proto/convert/scene_request.h"
#include "proto/convert/status.h"
#include "proto/wire/sha256.h"
#include "proto/wire/transport.h"
#include "server/meshing/load_grid.h"
#include "server/ops/guard.h"
#include "server/rpc/explain.h"

namespace tet {

namespace {

/// Says why a stored grid could not be loaded.
absl::Status explained(const absl::Status& status,
                       const VolumeKey& key,
                       const GridLease& grid) {
  return about_file(status, key.digest, grid->path.string(),
                    key.component ? GridUse::kField : GridUse::kSurface);
}

/// Counts one more for as long as it exists.
class Running {
 public:
  explicit Running(std::atomic<int>& count) : count_(count) { count_.fetch_add(1); }
  ~Running() { count_.fetch_sub(1); }
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;

 private:
  std::atomic<int>& count_;
};

/// What takes longer than any turn.
absl::Status takes_too_long(std::chrono::milliseconds taken, std::chrono::milliseconds limit) {
  const auto seconds = [](std::chrono::milliseconds time) {
    return static_cast<std::uint64_t>(std::chrono::ceil<std::chrono::seconds>(time).count());
  };
  return over_limit(
      "seconds of counting one mesh (a larger spacing or a smaller box takes fewer, and a job "
      "may take as many as it has)",
      seconds(taken), seconds(limit));
}

bool has_all_components(const VertexField& field) {
  const auto& components = field.components;
  return !components.empty() && components.size() >= components_of(components[0]->kind);
}

}  // namespace

Planner::Planner(const PlannerThreads& threads,
                 DecoderPool& decoders,
                 GridStore& store,
                 const PlannerMemory& memory,
                 MeshLimits limits)
    : threads_(threads),
      store_(store),
      limits_(limits),
      plans_(memory.plan_bytes),
      volumes_(threads.tasks,
               memory.volume_bytes,
               grid_loader(threads.loads, decoders, memory.volume_bytes),
               [this] { plans_.forget(); }) {}

void Planner::plan(const std::string& client,
                   MeshOrder order,
                   std::shared_ptr<PlanningWatch> watch,
                   Done done,
                   SurveyedBefore before) {
  const auto then = [this, done = std::move(done), before = std::move(before)](
                        const Job& job, const absl::Status& loaded) {
    loaded.ok() ? plan_loaded(job, before, done) : done(loaded);
  };
  load_shape({client, std::move(order), std::move(watch), then});
}

void Planner::load(const std::string& client,
                   MeshOrder order,
                   std::shared_ptr<PlanningWatch> watch,
                   Loaded done) {
  const auto then = [done = std::move(done)](Job job, const absl::Status& loaded) {
    if (!loaded.ok()) return done(loaded);
    done(PlanInput{std::move(job.shape), std::move(job.order.request), std::move(job.grids)});
  };
  load_shape({client, std::move(order), std::move(watch), then});
}

/// In one of the client's tasks.
void Planner::post(Job job, void (Planner::*step)(Job)) {
  const std::string client = job.client;
  threads_.tasks.post(
      client, [this, job = std::move(job), step] { job.guard([&] { (this->*step)(job); }); });
}

void Planner::load_shape(Job job) {
  if (job.order.is_scene()) {
    return post(std::move(job), &Planner::load_scene);
  }
  if (job.order.volume != nullptr) {
    job.shape = job.order.volume;
    return post(std::move(job), &Planner::load_sizes);
  }
  if (!job.order.grid_names.empty()) return load_several(std::move(job));
  if (job.order.request.labels) return load_labels(std::move(job));
  const VolumeKey key{job.order.space, job.order.digest, job.order.grid_name};
  load_grid(std::move(job), key, [this](Job loaded, GridLease grid, auto volume) {
    loaded.grids.push_back(std::move(grid));
    loaded.shape = std::move(volume);
    load_sizes(std::move(loaded));
  });
}

/// One after another.
void Planner::load_several(Job job) {
  const auto& names = job.order.grid_names;
  const std::size_t next = job.several.size();
  if (next == names.size()) {
    job.shape = std::exchange(job.several, {});
    return load_sizes(std::move(job));
  }
  const VolumeKey key{job.order.space, job.order.digest, names[next]};
  load_grid(std::move(job), key, [this](Job loaded, GridLease grid, auto volume) {
    if (loaded.grids.empty()) loaded.grids.push_back(std::move(grid));  // all of one file
    loaded.several.push_back(std::move(volume));
    load_several(std::move(loaded));
  });
}

void Planner::load_labels(Job job) {
  VolumeKey key{job.order.space, job.order.digest, job.order.grid_name};
  key.labels = true;
  load_any(std::move(job), key, [this](Job loaded, GridLease grid, const GridInMemory& labels) {
    loaded.grids.push_back(std::move(grid));
    loaded.shape = std::get<std::shared_ptr<const LabelVolume>>(labels);
    load_sizes(std::move(loaded));
  });
}

void Planner::load_grid(Job job, const VolumeKey& key, GridLoaded then) {
  load_any(std::move(job), key,
           [then = std::move(then)](Job loaded, GridLease grid, const GridInMemory& volume) {
             then(std::move(loaded), std::move(grid),
                  std::get<std::shared_ptr<const Volume>>(volume));
           });
}

void Planner::load_any(Job job, const VolumeKey& key, AnyLoaded then) {
  auto lease = store_.acquire({key.space, key.digest});
  if (!lease.ok()) {
    const std::string client = job.client;
    threads_.tasks.post(client, [job = std::move(job), key, status = lease.status()] {
      job.fail(key, status);
    });
    return;
  }
  const std::string path = (*lease)->path.string();
  VolumeCache::Request request;
  request.client = job.client;
  request.cancelled = [watch = job.watch] { return watch->cancellation.requested(); };
  request.answer = [this, job = std::move(job), key, grid = *std::move(lease),
                    then = std::move(then)](const auto& volume) mutable {
    if (volume.ok()) return job.guard([&] { then(job, std::move(grid), *volume); });
    if (absl::IsDataLoss(volume.status())) store_.set_aside(grid);
    job.fail(key, explained(volume.status(), key, grid));
  };
  volumes_.get(key, path, std::move(request));
}

void Planner::Job::fail(const VolumeKey& key, const absl::Status& status) const {
  if (key.component) return then(*this, about_field(status, field));
  const bool is_one_of_several = !order.grid_names.empty() && grids_of(shape) == nullptr;
  then(*this, is_one_of_several ? about_grid(status, several.size()) : status);
}

void Planner::Job::guard(const std::function<void()>& step) const {
  const absl::Status status = guarded("planning a mesh", step);
  if (!status.ok()) then(*this, status);
}

/// In a task; its grids one after another.
void Planner::load_scene(Job job) {
  if (job.order.made_scene != nullptr) {
    job.shape = job.order.made_scene;
    return load_sizes(std::move(job));
  }
  const auto grids = job.order.scene.grids();
  const auto next = std::ranges::find_if(
      grids, [](const scene::GridSolid* grid) { return grid->volume == nullptr; });
  if (next == grids.end()) return make_scene(std::move(job));
  const VolumeKey key{job.order.space, std::string(digest_of_name((*next)->file)),
                      (*next)->name};
  load_grid(std::move(job), key,
            [this, file = (*next)->file, name = (*next)->name](Job loaded, GridLease lease,
                                                               const auto& volume) {
              loaded.grids.push_back(std::move(lease));
              for (scene::GridSolid* grid : loaded.order.scene.grids()) {
                if (grid->file == file && grid->name == name) grid->volume = volume;
              }
              load_scene(std::move(loaded));
            });
}

/// In a task.
void Planner::make_scene(Job job) {
  const auto scene = scene_of_order(job.order);
  if (!scene.ok()) return job.then(job, within_field("mesh", scene.status()));
  job.shape = *scene;
  load_sizes(std::move(job));
}

/// In a task.
void Planner::load_sizes(Job job) {
  const auto& grid = job.order.request.sizing.grid;
  if (!grid) return load_fields(std::move(job));
  const std::string digest =
      grid->file.empty() ? job.order.digest : std::string(digest_of_name(grid->file));
  const VolumeKey key{job.order.space, digest, grid->name};
  load_grid(std::move(job), key, [this](Job loaded, const GridLease&, auto volume) {
    loaded.order.request.sizing.grid->volume = std::move(volume);
    load_fields(std::move(loaded));
  });
}

/// In a task. One component after the other: the first says how many there are.
void Planner::load_fields(Job job) {
  const auto& fields = job.order.request.fields;
  while (job.field < fields.size() && has_all_components(fields[job.field])) ++job.field;
  if (job.field == fields.size()) return job.then(job, absl::OkStatus());
  const VertexField& field = fields[job.field];
  const std::string digest =
      field.file.empty() ? job.order.digest : std::string(digest_of_name(field.file));
  const VolumeKey key{job.order.space, digest, field.grid,
                      static_cast<std::uint32_t>(field.components.size())};
  load_grid(std::move(job), key, [this](Job loaded, GridLease grid, auto volume) {
    loaded.grids.push_back(std::move(grid));
    loaded.order.request.fields[loaded.field].components.push_back(std::move(volume));
    load_fields(std::move(loaded));
  });
}

/// In a task.
void Planner::plan_loaded(const Job& job, const SurveyedBefore& before, const Done& done) {
  const std::string mesh_id = mesh_id_of(canonical_request(job.order, job.shape, nullptr));
  std::string name = absl::StrCat(job.order.space, " ", mesh_id);
  auto plan = plans_.recall(name);
  if (plan == nullptr && job.order.request.skip_statistics) {
    // A plan without them is for such requests only.
    absl::StrAppend(&name, " without statistics");
    plan = plans_.recall(name);
  }
  (plan == nullptr ? misses_ : hits_).fetch_add(1);
  if (plan != nullptr) return done(job.planned(std::move(plan)));
  auto work = [this, job, name, before, done](const PlanTurn& turn) {
    auto made = guarded("planning a mesh", [&]() -> absl::StatusOr<Attempt> {
      return make_plan(job, name, before, turn);
    });
    if (made.ok() && made->is_cut_short) return false;
    const absl::Status status = made.ok() ? made->plan.status() : made.status();
    done(status.ok() ? job.planned(*std::move(made->plan))
                     : absl::StatusOr<PlannedMesh>(about_mesh(status)));
    return true;
  };
  threads_.turns.post(job.client, estimate_bricks_to_plan(job.shape, job.order.request),
                      std::move(work));
}

PlannedMesh Planner::Job::planned(std::shared_ptr<const MeshPlan> plan) const {
  v1::MeshRequest canonical = canonical_request(order, shape, &plan->header());
  std::string mesh_id = mesh_id_of(canonical);
  return {std::move(plan), std::move(canonical), std::move(mesh_id), grids};
}

Planner::Attempt Planner::make_plan(const Job& job,
                                    const std::string& name,
                                    const SurveyedBefore& before,
                                    const PlanTurn& turn) {
  // Much may have happened while it waited.
  if (auto status = check_cancelled(job.watch->cancellation); !status.ok()) return {status};
  if (auto plan = plans_.recall(name)) return {plan};
  const Running running(running_);
  Attempt made = plan_in_turn(job, before, turn);
  give_back_free_memory();
  if (!made.plan.ok() || made.is_cut_short) return made;
  return {job.order.is_frame ? plans_.admit(*std::move(made.plan))
                             : plans_.remember(name, *std::move(made.plan))};
}

/// The turn's end stops the plan as its caller would. All turns but the last end by what the
/// plan's thread has used, so that a busy machine cuts no plan short; the last is an end for
/// everything.
Planner::Attempt Planner::plan_in_turn(const Job& job,
                                       const SurveyedBefore& before,
                                       const PlanTurn& turn) const {
  using Clock = Cancellation::Clock;
  const Cancellation& callers = job.watch->cancellation;
  const auto begin = std::chrono::steady_clock::now();
  const ThreadBudget use(turn.time);
  Cancellation stopped(
      turn.is_last ? std::min(callers.deadline(), Clock::now() + turn.time)
                   : callers.deadline(),
      turn.is_last ? Cancellation::Stop() : [&use] { return use.is_spent(); });
  const OnCancel link(callers, [&stopped] { stopped.cancel(); });
  MeshLimits limits = limits_;
  limits.max_plan_bytes = std::min(limits.max_plan_bytes, turn.bytes);
  const std::shared_ptr<const MeshPlan> earlier = before.earlier.lock();
  Attempt made{plan_mesh({.shape = job.shape,
                          .request = job.order.request,
                          .limits = limits,
                          .progress = &job.watch->progress,
                          .surveyed = before.blocks,
                          .earlier = earlier.get(),
                          .replaced = before.replaced.get()},
                         stopped)};
  if (made.plan.ok()) return made;
  if (callers.requested()) return {check_cancelled(callers)};
  if (stopped.requested()) {
    const auto taken = std::chrono::duration_cast<std::chrono::milliseconds>(
        std::chrono::steady_clock::now() - begin);
    // A clock that was set may end a turn, too.
    if (turn.is_last && taken >= turn.time) return {takes_too_long(taken, turn.time)};
    return {absl::CancelledError(), true};
  }
  const bool lacks_memory = absl::IsResourceExhausted(made.plan.status()) &&
                            limits.max_plan_bytes < limits_.max_plan_bytes;
  if (lacks_memory && !turn.is_last) made.is_cut_short = true;
  return made;
}

PlannerStats Planner::stats() const {
  return {volumes_.stats(), hits_.load(), misses_.load(), plans_.bytes(),
          plans_.budget_bytes()};
}

}  // namespace tet
