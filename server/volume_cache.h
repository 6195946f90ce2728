// Grids in memory, ready to mesh, shared by all requests for them.
#pragma once

#include <compare>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/parallel.h"
#include "core/grid/volume.h"

namespace tet {

/// Which grid of which file; an empty grid name means the file's only meshable one.
struct VolumeKey {
  std::string digest;
  std::string grid_name;
  friend auto operator<=>(const VolumeKey&, const VolumeKey&) = default;
};

/// Loads volumes once and keeps the most recently used under a byte budget.
///
/// Nobody waits: an answer comes as a task on the pool, and loads run on another, so that they
/// are in nobody's way. Thread safety: any thread may call `get`.
class VolumeCache {
 public:
  using Answer = std::function<void(const absl::StatusOr<std::shared_ptr<const Volume>>&)>;
  using Loader = std::function<absl::StatusOr<Volume>(const std::string& path,
                                                      const std::string& grid_name)>;

  /// `release` is asked to let go of volumes held elsewhere before a request is refused for
  /// room.
  VolumeCache(TaskPool& pool,
              TaskPool& loads,
              std::uint64_t budget_bytes,
              Loader loader,
              std::function<void()> release);

  /// Calls `answer` on the pool: with the volume, or the loader's error, or kResourceExhausted
  /// when it does not fit beside the volumes in use. Requests that meet share one load.
  void get(const VolumeKey& key, const std::string& path, Answer answer);

 private:
  using Loaded = absl::StatusOr<std::shared_ptr<const Volume>>;
  struct Entry {
    std::shared_ptr<const Volume> volume;  ///< null while it is loading
    std::uint64_t last_use = 0;
    std::vector<Answer> waiting;
  };

  void load(const VolumeKey& key, const std::string& path);
  Loaded admit(const VolumeKey& key, std::shared_ptr<const Volume> volume);
  std::uint64_t used_bytes() const;
  bool evict_oldest();

  TaskPool& pool_;
  TaskPool& loads_;
  const std::uint64_t budget_bytes_;
  const Loader loader_;
  const std::function<void()> release_;
  std::mutex mutex_;
  std::uint64_t clock_ = 0;
  std::map<VolumeKey, Entry> entries_;
};

}  // namespace tet
