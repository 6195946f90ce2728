// Sessions of stable ids in this process: what differs from the frame before is made again.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "client/library/api/core_request.h"
#include "client/library/api/local_frames.h"
#include "client/library/api/stable_session_impl.h"
#include "client/library/api/to_public.h"
#include "core/base/parallel.h"
#include "core/base/scratch_pool.h"
#include "core/mesh/stable/stable_mesh.h"
#include "core/plan/fill_watch.h"
#include "core/plan/make/plan_mesh.h"
#include "core/plan/mesh_workspace.h"
#include "core/transfer/mesh_patch.h"

namespace tetstream {
namespace {

/// Patches that are made side by side before they are put where they belong.
constexpr std::uint64_t kPatchesAtOnce = 32;

using Plan = std::shared_ptr<const tet::MeshPlan>;

/// Makes every frame as a server and its client would together.
class LocalStableFrames final : public FrameMaker<StableFrame> {
 public:
  LocalStableFrames(tet::MeshRequest request,
                    const WorkOptions& options,
                    const tet::Cancellation& cancellation)
      : request_(std::move(request)), pool_(options.threads), cancellation_(cancellation) {}

  /// `replaced` may be null: see tet::PlanJob.
  template <class Solid>
  Result<StableFrame> frame(const Solid& solid,
                            const std::vector<tet::BrickCoord>* replaced = nullptr) {
    auto shape = shape_of(solid);
    if (!shape.ok()) return to_public(shape.status());
    absl::Status status;
    pool_.run([&] { status = follow(*std::move(shape), replaced); });
    if (!status.ok()) return to_public(status);
    tet::TrailerFacts facts{std::nullopt, plan_->boundary(), plan_->improvement(),
                            plan_->thin_walls()};
    // Where parts were kept it is that of the rest.
    const std::uint64_t tets = plan_->header().tet_count;
    if (tets_made_ == tets && !quality_.empty()) facts.quality = quality_;
    return StableFrame{.ids = &mesh_, .facts = facts, .tets_sent = tets_made_};
  }

  Result<StableFrame> make(const Volume& before,
                           const Volume& after,
                           const ReplacedBoxes& replaced) override {
    const auto bricks = replaced_bricks(before, after, replaced);
    if (!bricks.ok()) return to_public(bricks.status());
    return frame(after, *bricks ? &**bricks : nullptr);
  }
  Result<StableFrame> make(const Scene& scene) override { return frame(scene); }
  bool is_over() const override { return half_patched_ || cancellation_.requested(); }
  Status end() override { return {}; }

 private:
  /// On the pool.
  absl::Status follow(tet::Shape shape, const std::vector<tet::BrickCoord>* replaced) {
    absl::StatusOr<Plan> made = plan_mesh({.shape = std::move(shape),
                                           .request = request_,
                                           .earlier = plan_.get(),
                                           .replaced = replaced},
                                          cancellation_);
    if (!made.ok()) return made.status();
    const Plan plan = *std::move(made);
    const auto patch = tet::MeshPatch::between(as_bricks(plan_), as_bricks(plan), cancellation_,
                                               tet::PatchDetail::kSlices);
    if (auto status = check_cancelled(cancellation_); !status.ok()) return status;
    half_patched_ = true;
    if (auto status = mesh_.begin(plan->header(), patch ? &patch->kept() : nullptr);
        !status.ok()) {
      return status;
    }
    tets_made_ = 0;
    quality_ = {};
    const absl::Status filled = patch ? fill(*patch, plan->header()) : fill(*plan);
    if (!filled.ok()) return filled;
    half_patched_ = false;
    keep_lattice(plan->header(), request_);
    plan_ = plan;
    return absl::OkStatus();
  }

  /// Calls `fill(i, workspace)` for each index, side by side.
  template <class Fill>
  std::vector<tet::QualityStats> fill_each(std::uint64_t count, const Fill& fill) {
    std::vector<tet::QualityStats> stats(count);
    tet::for_each_range(count, 1, [&](std::size_t begin, std::size_t end) {
      const tet::ScratchPool<tet::MeshWorkspace>::Turn workspace(workspaces_);
      const tet::WatchedFill watched(*workspace, cancellation_);
      for (std::size_t i = begin; i < end && !cancellation_.requested(); ++i) {
        stats[i] = fill(i, *workspace);
      }
    });
    return stats;
  }

  absl::Status fill(const tet::MeshPlan& plan) {
    std::vector<tet::ChunkColumns> places;
    for (std::uint64_t i = 0; i < plan.header().chunk_count; ++i) {
      places.push_back(mesh_.place(plan.chunk(i)));
    }
    const auto stats = fill_each(places.size(), [&](std::size_t i, auto& workspace) {
      return plan.fill_chunk(i, workspace, places[i]);
    });
    for (const tet::QualityStats& chunk : stats) quality_.add(chunk);
    tets_made_ = plan.header().tet_count;
    return check_cancelled(cancellation_);
  }

  absl::Status fill(const tet::MeshPatch& patch, const tet::MeshHeader& header) {
    made_.resize(kPatchesAtOnce);
    for (std::uint64_t first = 0; first < patch.patch_count(); first += kPatchesAtOnce) {
      const std::uint64_t count = std::min(kPatchesAtOnce, patch.patch_count() - first);
      fill_each(count, [&](std::size_t i, auto& workspace) {
        made_[i] =
            tet::TetMesh(header_of_chunk(header, patch.extent(first + i)), std::move(made_[i]));
        return patch.fill(first + i, workspace, made_[i].columns());
      });
      if (auto status = check_cancelled(cancellation_); !status.ok()) return status;
      for (std::uint64_t i = 0; i < count; ++i) {
        if (auto status = put(patch.extent(first + i), made_[i]); !status.ok()) return status;
      }
    }
    return absl::OkStatus();
  }

  absl::Status put(const tet::ChunkExtent& extent, tet::TetMesh& made) {
    const auto from = made.columns().all(), to = mesh_.place(extent).all();
    for (std::size_t column = 0; column < from.size(); ++column) {
      std::ranges::copy(from[column], to[column].begin());
    }
    tets_made_ += extent.tet_count;
    return mesh_.take(extent);
  }

  tet::MeshRequest request_;
  tet::TaskPool pool_;
  const tet::Cancellation& cancellation_;
  Plan plan_;
  tet::StableMesh mesh_;
  tet::ScratchPool<tet::MeshWorkspace> workspaces_;
  std::vector<tet::TetMesh> made_;  ///< patches; memory for the next ones
  tet::QualityStats quality_;
  std::uint64_t tets_made_ = 0;
  bool half_patched_ = false;
};

template <class Solid>
Result<StableSession> begin_stable(const Solid& solid,
                                   std::optional<Volume> volume,
                                   const Request& request,
                                   const WorkOptions& options) {
  return guarded([&]() -> Result<StableSession> {
    absl::StatusOr<tet::MeshRequest> core = session_request(request);
    if (!core.ok()) return to_public(core.status());
    auto session = std::make_unique<StableSession::Impl>(options);
    auto frames = std::make_unique<LocalStableFrames>(*std::move(core), options,
                                                      session->work.cancellation());
    Result<StableFrame> first = frames->frame(solid);
    if (!first.ok()) return first.status();
    session->volume = std::move(volume);
    return begun(std::move(session), std::move(frames), *std::move(first));
  });
}

}  // namespace

Result<StableSession> begin_stable_session(const Volume& volume,
                                           const Request& request,
                                           const WorkOptions& options) {
  return begin_stable(volume, volume, request, options);
}

Result<StableSession> begin_stable_session(const Scene& scene,
                                           const Request& request,
                                           const WorkOptions& options) {
  return begin_stable(scene, std::nullopt, request, options);
}

}  // namespace tetstream
