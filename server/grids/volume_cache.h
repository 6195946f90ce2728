// Grids in memory, ready to mesh, shared by all requests for them.
#pragma once

#include <compare>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <absl/status/statusor.h>

#include "core/volume/label_volume.h"
#include "core/volume/volume.h"
#include "server/ops/last_time.h"
#include "server/rpc/fair_tasks.h"

namespace tet {

/// A grid, or a segmentation; never null.
using GridInMemory =
    std::variant<std::shared_ptr<const Volume>, std::shared_ptr<const LabelVolume>>;

/// Which grid of which file, and what for; an empty grid name means the file's only one that
/// will do. What one namespace has in memory is not found faster by another.
struct VolumeKey {
  std::string space;
  std::string digest;
  std::string grid_name;
  std::optional<std::uint32_t> component = {};  ///< of a field; unset: to be meshed
  bool labels = false;                          ///< of a segmentation
  friend auto operator<=>(const VolumeKey&, const VolumeKey&) = default;
};

/// What a cache holds, and what went since it was made.
struct CacheStats {
  std::uint64_t bytes = 0, budget_bytes = 0;
  std::uint64_t grids = 0, evicted = 0;
};

/// Loads volumes once and keeps the most recently used under a byte budget.
///
/// Nobody waits: an answer comes as a task of the client who asked. Thread safety: any thread
/// may call `get`.
class VolumeCache {
 public:
  using Answer = std::function<void(const absl::StatusOr<GridInMemory>&)>;
  using Cancelled = std::function<bool()>;
  struct Request {
    std::string client;
    Cancelled cancelled;
    Answer answer;
  };

  /// What is to be read, and in whose turn: whoever asked first.
  struct Load {
    VolumeKey key;
    std::string path;
    std::string client;
  };
  /// Has the volume read elsewhere, until nobody wants it any more; calls `done` once, on any
  /// thread. Where it throws, or lets go of `done` uncalled, the load has failed.
  using LoadDone = std::function<void(absl::StatusOr<GridInMemory>)>;
  using Loader = std::function<void(const Load& load, Cancelled abandoned, LoadDone done)>;

  /// `release` is asked to let go of volumes held elsewhere before a request is refused for
  /// room.
  VolumeCache(FairTasks& tasks,
              std::uint64_t budget_bytes,
              Loader loader,
              std::function<void()> release);

  /// Answers the request in one of its client's tasks: with the volume, or the loader's error,
  /// or kResourceExhausted when it does not fit beside the volumes in use. Requests that meet
  /// share one load, which ends early once all of them are `cancelled`.
  void get(const VolumeKey& key, const std::string& path, Request request);

  CacheStats stats() const;
  /// Whether a volume was refused since `then`, as others in use left no room for it.
  bool has_refused_since(LastTime::Clock::time_point then) const noexcept {
    return refused_.is_since(then);
  }

 private:
  using Loaded = absl::StatusOr<GridInMemory>;
  struct Entry {
    std::optional<GridInMemory> grid;  ///< nothing while it is loading
    std::uint64_t last_use = 0;
    std::vector<Request> waiting;
  };

  class Ending;

  void load(const Load& load);
  void finish_load(const Load& load, Loaded read);
  bool is_abandoned(const VolumeKey& key);
  Loaded admit(const VolumeKey& key, const GridInMemory& grid);
  std::uint64_t used_bytes() const;
  bool evict_oldest();

  FairTasks& tasks_;
  const std::uint64_t budget_bytes_;
  const Loader loader_;
  const std::function<void()> release_;
  LastTime refused_;
  mutable std::mutex mutex_;
  std::uint64_t clock_ = 0;
  std::uint64_t evicted_ = 0;
  std::map<VolumeKey, Entry> entries_;
};

}  // namespace tet
