// The survey of a mesh that several workers count together, block by block, in the result
// store.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "core/plan/surveyed_blocks.h"
#include "proto/wire/block_pool.h"
#include "server/jobs/results/result_store.h"

namespace tet {

/// Which survey: of what request, in blocks of how many bricks.
struct SurveyName {
  std::string space;
  std::string request;  ///< see name_of_request
  std::int64_t block_bricks = 0;
};

/// Blocks lie in a MeshFolder as chunks do, each as a shard of its own: whole or not at all,
/// and checked when they are read. They are evicted like meshes; what is gone is surveyed
/// again.
///
/// Thread safety: every member may be called from any thread.
class SharedSurvey {
 public:
  /// Errors: the disk's.
  static absl::StatusOr<std::shared_ptr<SharedSurvey>> open(ResultStore& results,
                                                            BlockPool& memory,
                                                            const SurveyName& name);

  SharedSurvey(ResultStore& results,
               BlockPool& memory,
               std::shared_ptr<MeshFolder> folder,
               std::int64_t block_bricks)
      : results_(results),
        memory_(memory),
        folder_(std::move(folder)),
        block_bricks_(block_bricks) {}

  /// Digest of a block that is there.
  std::optional<ChunkDigest> digest_of(std::int64_t block) const;
  /// Stores a block. Errors: kDataLoss (DETERMINISM_ALARM: another was stored before),
  /// kResourceExhausted, and the disk's.
  absl::StatusOr<ChunkDigest> put(std::int64_t block, std::span<const std::byte> bytes);

  /// What of it is there, for planning; keeps it from being evicted.
  static SurveyedBlocks blocks(std::shared_ptr<const SharedSurvey> survey);

 private:
  std::optional<std::vector<std::byte>> get(std::int64_t block) const;

  ResultStore& results_;
  BlockPool& memory_;
  const std::shared_ptr<MeshFolder> folder_;
  const std::int64_t block_bricks_;
};

}  // namespace tet
