// A mesh that a job has made, read from where it is stored.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include <absl/status/statusor.h>

#include "server/jobs/results/job_spec.h"
#include "server/jobs/results/result_store.h"

namespace tet {

/// Chunks [first, end) of a stored mesh; nobody evicts it while this exists. Immutable: any
/// thread may call any member.
class StoredMesh {
 public:
  /// Null where not all of these chunks are stored; `end` 0 means all from `first` on. Reads
  /// the names of the chunks, not their bytes.
  static std::shared_ptr<const StoredMesh> find(const ResultStore& results,
                                                const std::string& space,
                                                stored::JobPlan plan,
                                                std::uint64_t first = 0,
                                                std::uint64_t end = 0);
  /// Finds a mesh that nobody has counted here by the name of its request: see
  /// ResultStore::put_plan.
  static std::shared_ptr<const StoredMesh> find(const ResultStore& results,
                                                const std::string& space,
                                                const std::string& request_name,
                                                std::uint64_t first = 0,
                                                std::uint64_t end = 0);

  StoredMesh(stored::JobPlan plan,
             std::shared_ptr<const MeshFolder> folder,
             std::uint64_t first_chunk,
             std::string digests)
      : plan_(std::move(plan)),
        folder_(std::move(folder)),
        first_chunk_(first_chunk),
        digests_(std::move(digests)) {}

  const stored::JobPlan& plan() const noexcept { return plan_; }
  std::uint64_t chunk_count() const noexcept {
    return static_cast<std::uint64_t>(plan_.header().chunk_count());
  }
  /// Errors: those of MeshFolder::get_chunk.
  absl::StatusOr<ChunkMessage> chunk(std::uint64_t index,
                                     BlockPool& blocks,
                                     std::shared_ptr<SendBudget::Lease> held) const;

 private:
  const stored::JobPlan plan_;
  const std::shared_ptr<const MeshFolder> folder_;
  const std::uint64_t first_chunk_;  ///< of those whose digests follow
  const std::string digests_;        ///< 32 bytes each
};

}  // namespace tet
