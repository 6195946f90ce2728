// Stored meshes that go to make room, and those that stay all the same.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include <absl/status/status.h>
#include <absl/time/time.h>

#include "server/jobs/results/result_store.h"

namespace tet {

/// The end of a folder's name that is on its way out.
inline constexpr char kEvicted[] = ".evicted";

struct FoundMesh {
  ResultKey key;
  std::filesystem::path path;
  std::uint64_t bytes = 0;
  absl::Time last_use;
};

struct Evicted {
  std::uint64_t bytes = 0, meshes = 0;
  absl::Status status;  ///< not OK where `needed` failed, with which nothing more was evicted
};

/// Evicts meshes in this order until `bytes` are free, but none that somebody uses or needs.
Evicted evict_meshes(std::span<const FoundMesh> meshes,
                     std::uint64_t bytes,
                     const ResultStore::Needed& needed);

}  // namespace tet
