#include "server/planner.h"

#include <absl/strings/str_cat.h>

#include "core/decode/decode_file.h"
#include "core/pipeline/budget.h"
#include "proto/wire/sha256.h"
#include "proto/wire/transport.h"
#include "server/explain.h"
#include "server/verify.h"

namespace tet {

namespace {
// A tenth of a second or so of one core.
constexpr double kLargePlanBricks = 4096;

/// Has a stored grid read by a decoder, and what it hands back checked by the pool.
VolumeCache::Loader loader(TaskPool& pool, DecoderPool& decoders, std::uint64_t max_bytes) {
  return [&pool, &decoders, max_bytes](const VolumeKey& key, const std::string& path,
                                       VolumeCache::Cancelled abandoned,
                                       VolumeCache::LoadDone done) {
    const FileRequest request{DecodeTask::kVolume, path, name_of_grid(key.digest),
                              key.grid_name, max_bytes};
    pool.post([&pool, &decoders, request, abandoned = std::move(abandoned),
               done = std::move(done)]() mutable {
      if (absl::Status intact = verify_stored(request.path); !intact.ok()) return done(intact);
      decoders.decode(
          request, std::move(abandoned),
          [&pool, request, done = std::move(done)](absl::StatusOr<SealedBlock> decoded) {
            auto block = std::make_shared<absl::StatusOr<SealedBlock>>(std::move(decoded));
            pool.post([request, done, block] { done(volume_of(*block, request)); });
          });
    });
  };
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
      volumes_(threads.pool,
               memory.volume_bytes,
               loader(threads.pool, decoders, memory.volume_bytes),
               [this] { plans_.forget(); }) {}

void Planner::plan(const std::string& client,
                   MeshOrder order,
                   std::shared_ptr<PlanningWatch> watch,
                   Done done) {
  Job job{client, std::move(order), std::move(watch), std::move(done)};
  if (job.order.scene == nullptr) return plan_grid(std::move(job));
  job.shape = job.order.scene;
  threads_.pool.post([this, job = std::move(job)] { plan_input(job); });
}

void Planner::plan_grid(Job job) {
  const MeshOrder& order = job.order;
  auto grid = store_.acquire({order.space, order.digest});
  if (!grid.ok()) {
    threads_.pool.post([done = std::move(job.done), status = grid.status()] { done(status); });
    return;
  }
  const VolumeKey key{order.space, order.digest, order.grid_name};
  const std::string path = (*grid)->path.string();
  const auto cancelled = [watch = job.watch] { return watch->cancellation.requested(); };
  job.grid = *std::move(grid);
  volumes_.get(key, path, cancelled, [this, job = std::move(job)](const auto& volume) mutable {
    if (!volume.ok()) {
      const StoredGrid& file = *job.grid;
      if (absl::IsDataLoss(volume.status())) store_.set_aside(job.grid);
      return job.done(about_file(volume.status(), file.key.digest, file.path.string()));
    }
    job.shape = *volume;
    plan_input(std::move(job));
  });
}

/// On the pool.
void Planner::plan_input(Job job) {
  const std::string mesh_id = mesh_id_of(canonical_request(job.order, job.shape, nullptr));
  job.name = absl::StrCat(job.order.space, " ", mesh_id);
  auto plan = plans_.recall(job.name);
  (plan == nullptr ? misses_ : hits_).fetch_add(1);
  if (plan != nullptr) return job.done(job.planned(std::move(plan)));
  const bool large = estimate_bricks_to_plan(job.shape, job.order.request) > kLargePlanBricks;
  const std::string client = job.client;
  auto work = [this, job = std::move(job)] {
    auto made = make_plan(job);
    job.done(made.ok() ? job.planned(*std::move(made))
                       : absl::StatusOr<PlannedMesh>(about_mesh(made.status())));
  };
  large ? threads_.large.post(client, std::move(work)) : work();
}

PlannedMesh Planner::Job::planned(std::shared_ptr<const MeshPlan> plan) const {
  v1::MeshRequest canonical = canonical_request(order, shape, &plan->header());
  std::string mesh_id = mesh_id_of(canonical);
  return {std::move(plan), std::move(canonical), std::move(mesh_id), grid};
}

absl::StatusOr<std::shared_ptr<const MeshPlan>> Planner::make_plan(const Job& job) {
  // Much may have happened while it waited.
  if (auto status = check_cancelled(job.watch->cancellation); !status.ok()) return status;
  if (auto plan = plans_.recall(job.name)) return plan;
  running_.fetch_add(1);
  auto plan = plan_mesh(job.shape, job.order.request, limits_, job.watch->cancellation,
                        &job.watch->progress);
  running_.fetch_sub(1);
  give_back_free_memory();
  if (!plan.ok()) return plan.status();
  return plans_.remember(job.name, *std::move(plan));
}

PlannerStats Planner::stats() const {
  return {volumes_.stats(), hits_.load(), misses_.load(), plans_.bytes(),
          plans_.budget_bytes()};
}

}  // namespace tet
