// Meshes that jobs made, on disk, under a size budget.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>
#include <absl/time/time.h>

#include "server/jobs/results/mesh_folder.h"
#include "server/jobs/results/result_ledger.h"

namespace tet {

/// Whose mesh, and which: its mesh_id names the action that made it.
struct ResultKey {
  std::string space;
  std::string mesh_id;
  auto operator<=>(const ResultKey&) const = default;
};

/// A chunk that a folder has.
struct PutChunk {
  ChunkDigest digest;
  bool is_new = false;  ///< it was not there before, and found room
};

struct ResultStats {
  std::uint64_t bytes = 0, budget_bytes = 0, meshes = 0;
  std::uint64_t evicted = 0;  ///< meshes, by this process
};

/// `{space}/meshes/ab/{mesh_id}` is a MeshFolder, and `{space}/plans/{key}` what counting found
/// for a request. The namespaces share the budget, and so do processes, on one host or on many
/// that share a file system: what all have stored is in one account, beside the meshes.
///
/// Thread safety: every member may be called from any thread.
class ResultStore {
 public:
  struct Limits {
    std::uint64_t budget_bytes = 0;
    std::uint64_t keep_free_bytes = 0;                       ///< of the disk, for others
    absl::Duration keep_damaged = absl::InfiniteDuration();  ///< chunks that were set aside
  };

  /// Meshes that must stay though nobody uses them, by whoever knows: asked when room is short.
  /// Where it fails nothing is evicted, and whoever needs room hears its error.
  using Needed = std::function<absl::StatusOr<std::set<ResultKey>>()>;

  /// Makes no folder before anything is stored: a folder where nothing is mounted stays empty.
  static absl::StatusOr<std::unique_ptr<ResultStore>> open(const std::filesystem::path& root,
                                                           const Limits& limits,
                                                           Needed needed = nullptr);

  /// Opens a mesh's folder to add to it: it is not evicted while anyone holds it.
  absl::StatusOr<std::shared_ptr<MeshFolder>> make(const ResultKey& key);
  /// Opens a folder that is there already. Errors: kNotFound.
  absl::StatusOr<std::shared_ptr<MeshFolder>> find(const ResultKey& key) const;

  /// Adds a chunk to a folder of this store, unless it has that already.
  /// Room is made before: what was used least recently is evicted if need be. Errors:
  /// kResourceExhausted with reason RESULTS_FULL (all of the rest is in use, or needed) or
  /// DISK_FULL (what is free of the disk is to stay free), those of ResultLedger and of
  /// `Needed`, and the disk's.
  absl::StatusOr<PutChunk> put_chunk(MeshFolder& folder, const ChunkMessage& chunk);

  /// Whether a mesh of so many bytes could be stored if every other went. Errors:
  /// kResourceExhausted with LIMIT_EXCEEDED (the budget, or the disk, is too small), or
  /// RESULTS_FULL (something else has filled the disk, and may make room again).
  absl::Status check_fits(std::uint64_t bytes);
  /// Whether it could be if nobody else had anything on the disk, either. Errors:
  /// kResourceExhausted with LIMIT_EXCEEDED.
  absl::Status check_ever_fits(std::uint64_t bytes) const;

  /// What counting found for a request of this name, 64 hexadecimal digits: of use as long as
  /// the mesh is stored.
  absl::Status put_plan(const ResultKey& mesh, const std::string& name, const std::string&);
  std::optional<std::string> find_plan(const std::string& space, const std::string& name) const;
  /// Keeps the plan for a while longer, though its mesh is not begun.
  void keep_plan(const std::string& space, const std::string& name) const;

  /// Looks at all that is there, evicts what is over the budget, and clears away what is of no
  /// use any more: plans of meshes that are gone, damaged chunks, what was never finished.
  void sweep();
  /// Whether the disk takes a few kilobytes. Errors: kResourceExhausted (DISK_FULL), the
  /// disk's.
  absl::Status probe() const;
  ResultStats stats() const;
  std::uint64_t budget_bytes() const noexcept { return limits_.budget_bytes; }

 private:
  ResultStore(std::filesystem::path root, const Limits& limits, Needed needed)
      : root_(std::move(root)), limits_(limits), needed_(std::move(needed)), ledger_(root_) {}

  class Room;
  absl::StatusOr<std::unique_ptr<Room>> reserve(std::uint64_t bytes);
  void give_back(std::uint64_t bytes);
  std::filesystem::path mesh_path(const ResultKey& key) const;
  std::filesystem::path plan_path(const std::string& space, const std::string& name) const;
  std::uint64_t count_bytes();
  absl::Status sweep_to(std::uint64_t budget_bytes, std::uint64_t free_bytes = 0);
  absl::Status sweep_in(ResultLedger::Turn& turn,
                        std::uint64_t budget_bytes,
                        std::uint64_t free_bytes = 0);
  absl::Status make_room_on_disk(std::uint64_t bytes);
  void clear_plans(const std::string& space);

  const std::filesystem::path root_;
  const Limits limits_;
  const Needed needed_;
  const ResultLedger ledger_;
  std::atomic<std::uint64_t> bytes_{0};  ///< of all processes, when this one looked last
  std::atomic<std::uint64_t> meshes_{0}, evicted_{0};
};

}  // namespace tet
