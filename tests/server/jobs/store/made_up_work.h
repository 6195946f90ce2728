// Plans and digests for shards that nobody makes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <absl/strings/str_cat.h>
#include <absl/time/clock.h>
#include <absl/time/time.h>

#include "server/jobs/store/job.h"

namespace tet::test {

/// Digests of made-up chunks; another salt stands for other bytes.
inline std::vector<ChunkDigest> digests_of(ChunkRange range, char salt = 'a') {
  std::vector<ChunkDigest> digests;
  for (auto chunk = range.first; chunk < range.end; ++chunk) {
    std::string digest = absl::StrCat(std::string(1, salt), chunk);
    digest.resize(32, '.');
    digests.push_back(digest);
  }
  return digests;
}

inline Plan plan_of(std::int64_t shards,
                    std::int64_t chunks_each = 1,
                    Phase phase = Phase::kMesh) {
  Plan plan{phase, "header", {}};
  for (std::int64_t i = 0; i < shards; ++i) {
    plan.shards.push_back({i * chunks_each, (i + 1) * chunks_each});
  }
  return plan;
}

}  // namespace tet::test
