// Meshes that jobs made, on disk, under a size budget.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include <absl/status/status.h>
#include <absl/status/statusor.h>
#include <absl/time/time.h>

#include "server/jobs/results/mesh_folder.h"

namespace tet {

/// Whose mesh, and which: its mesh_id names the action that made it.
struct ResultKey {
  std::string space;
  std::string mesh_id;
};

struct ResultStats {
  std::uint64_t bytes = 0, budget_bytes = 0, meshes = 0;
  std::uint64_t evicted = 0;  ///< meshes, by this process
};

/// `{space}/meshes/ab/{mesh_id}` is a MeshFolder, and `{space}/plans/{key}` what counting found
/// for a request. The namespaces share the budget, and so may processes, on one host or on many
/// that share a file system: each counts what is there when it looks, and what it adds itself.
///
/// Thread safety: every member may be called from any thread.
class ResultStore {
 public:
  /// Damaged chunks that were set aside are kept for as long as told. A disk that is full is no
  /// reason to fail: what needs room then does. Errors: the disk's.
  static absl::StatusOr<std::unique_ptr<ResultStore>> open(
      const std::filesystem::path& root,
      std::uint64_t budget_bytes,
      absl::Duration keep_damaged = absl::InfiniteDuration());

  /// Opens a mesh's folder to add to it: it is not evicted while anyone holds it.
  absl::StatusOr<std::shared_ptr<MeshFolder>> make(const ResultKey& key);
  /// Opens a folder that is there already. Errors: kNotFound.
  absl::StatusOr<std::shared_ptr<MeshFolder>> find(const ResultKey& key) const;

  /// Makes room for `bytes`, and is asked before they are added: evicts what was used least
  /// recently if need be. Errors: kResourceExhausted with reason RESULTS_FULL (all of the rest
  /// is in use).
  absl::Status reserve(std::uint64_t bytes);

  /// What counting found for a request of this name, 64 hexadecimal digits: of use as long as
  /// the mesh is stored.
  absl::Status put_plan(const ResultKey& mesh, const std::string& name, const std::string&);
  std::optional<std::string> find_plan(const std::string& space, const std::string& name) const;

  /// Looks at all that is there, evicts what is over the budget, and clears away what is of no
  /// use any more: plans of meshes that are gone, damaged chunks, what was never finished.
  void sweep();
  /// Whether the disk takes a few kilobytes. Errors: kResourceExhausted (DISK_FULL), the
  /// disk's.
  absl::Status probe() const;
  ResultStats stats() const;
  std::uint64_t budget_bytes() const noexcept { return budget_bytes_; }

 private:
  ResultStore(std::filesystem::path root,
              std::uint64_t budget_bytes,
              absl::Duration keep_damaged)
      : root_(std::move(root)), budget_bytes_(budget_bytes), keep_damaged_(keep_damaged) {}

  std::filesystem::path mesh_path(const ResultKey& key) const;
  std::filesystem::path plan_path(const std::string& space, const std::string& name) const;
  void sweep_to(std::uint64_t budget_bytes);
  void clear_plans(const std::string& space);
  bool evict(const std::filesystem::path& folder);

  const std::filesystem::path root_;
  const std::uint64_t budget_bytes_;
  const absl::Duration keep_damaged_;
  std::mutex sweeping_;
  std::atomic<std::uint64_t> bytes_{0}, meshes_{0}, evicted_{0};
};

}  // namespace tet
