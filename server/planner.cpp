#include "server/planner.h"

#include <algorithm>

#include <absl/strings/str_cat.h>

#include "core/decode/decode_file.h"
#include "proto/wire/sha256.h"
#include "proto/wire/transport.h"
#include "server/explain.h"
#include "server/verify.h"

namespace tet {

namespace {
// Enough for the streams that are likely to come back; each may hold a volume in memory,
// and the positions of an improved mesh.
constexpr std::size_t kRecentPlans = 4;

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

Planner::Planner(TaskPool& pool,
                 DecoderPool& decoders,
                 GridStore& store,
                 std::uint64_t resident_bytes,
                 MeshLimits limits)
    : pool_(pool),
      store_(store),
      limits_(limits),
      volumes_(
          pool, resident_bytes, loader(pool, decoders, resident_bytes), [this] { forget(); }) {}

void Planner::plan(MeshOrder order, std::shared_ptr<PlanningWatch> watch, Done done) {
  auto grid = store_.acquire({order.space, order.digest});
  if (!grid.ok()) {
    pool_.post([done = std::move(done), status = grid.status()] { done(status); });
    return;
  }
  const VolumeKey key{order.space, order.digest, order.grid_name};
  const std::string path = (*grid)->path.string();
  const auto cancelled = [watch] { return watch->cancellation.requested(); };
  volumes_.get(key, path, cancelled,
               [this, order = std::move(order), watch = std::move(watch),
                done = std::move(done), grid = *std::move(grid)](const auto& volume) {
                 if (volume.ok()) return done(plan_volume(order, *volume, grid, *watch));
                 if (absl::IsDataLoss(volume.status())) store_.set_aside(grid);
                 done(about_file(volume.status(), grid->key.digest, grid->path.string()));
               });
}

absl::StatusOr<PlannedMesh> Planner::plan_volume(const MeshOrder& order,
                                                 std::shared_ptr<const Volume> volume,
                                                 GridLease grid,
                                                 PlanningWatch& watch) {
  const std::string name =
      absl::StrCat(order.space, " ", mesh_id_of(canonical_request(order, *volume, nullptr)));
  std::shared_ptr<const MeshPlan> plan = recall(name);
  (plan == nullptr ? misses_ : hits_).fetch_add(1);
  if (plan == nullptr) {
    running_.fetch_add(1);
    auto planned =
        plan_mesh(volume, order.request, limits_, watch.cancellation, &watch.progress);
    running_.fetch_sub(1);
    give_back_free_memory();
    if (!planned.ok()) return about_mesh(planned.status());
    plan = *std::move(planned);
    remember(name, plan);
  }
  v1::MeshRequest canonical = canonical_request(order, *volume, &plan->header());
  std::string mesh_id = mesh_id_of(canonical);
  return PlannedMesh{std::move(plan), std::move(canonical), std::move(mesh_id),
                     std::move(grid)};
}

PlannerStats Planner::stats() const { return {volumes_.stats(), hits_.load(), misses_.load()}; }

std::shared_ptr<const MeshPlan> Planner::recall(const std::string& name) {
  const std::lock_guard lock(mutex_);
  const auto found = std::find_if(recent_.begin(), recent_.end(),
                                  [&](const NamedPlan& plan) { return plan.first == name; });
  if (found == recent_.end()) return nullptr;
  recent_.splice(recent_.begin(), recent_, found);
  return recent_.front().second;
}

void Planner::remember(std::string name, std::shared_ptr<const MeshPlan> plan) {
  const std::lock_guard lock(mutex_);
  recent_.emplace_front(std::move(name), std::move(plan));
  if (recent_.size() > kRecentPlans) recent_.pop_back();
}

void Planner::forget() {
  const std::lock_guard lock(mutex_);
  recent_.clear();
}

}  // namespace tet
