// Grid files on disk, named by their SHA-256, under a size budget.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>
#include <absl/time/time.h>

#include "core/base/posix/file.h"
#include "server/grids/grid_changes.h"
#include "server/grids/store_lock.h"
#include "server/grids/stored_grids.h"
#include "server/rpc/default_namespace.h"

namespace tet {

class GridUpload;

/// What is there of one file.
struct UploadState {
  std::uint64_t committed_size = 0;
  bool complete = false;
};

struct ListedGrid {
  std::string digest;
  std::uint64_t size_bytes = 0;
  absl::Time last_use;
};

/// Who sends a file, and how much of what is not whole yet may be theirs.
struct Uploader {
  std::string name;
  std::uint64_t max_bytes = ~std::uint64_t{0};
  std::size_t max_files = 10'000;
};

/// Files of a store, whole or not: each takes an inode, a block of the disk and some 600 bytes
/// of memory, however small it is, of which the budget in bytes knows nothing.
inline constexpr std::size_t kMostStoredFiles = 1'000'000;

/// What a store holds, and what went since it was opened.
struct StoreStats {
  std::uint64_t bytes = 0, budget_bytes = 0;
  std::uint64_t files = 0, uploads = 0;
  std::uint64_t evicted_files = 0, evicted_uploads = 0;
  std::uint64_t corrupt_files = 0;  ///< found damaged and set aside
};

/// A content-addressed directory: `grids/ab/{sha256}` for whole files and
/// `uploads/{sha256}.part` for those under way; those of another namespace than the default one
/// are below `namespaces/{name}`. All survive a restart; a whole file appears by an atomic
/// rename only. The namespaces share the budget.
///
/// Several servers may share a directory, on one host or on many. What they add and remove they
/// tell each other in its journal (GridChanges), one at a time. Whoever uses a whole file
/// shares its lock, and whoever sends an upload has its part's alone; both end with the
/// process. Files that others have are found when they are asked for.
///
/// Digests are 64 lower-case hexadecimal digits, and namespaces fit to be folders; the caller
/// has checked that. Thread safety: every member may be called from any thread.
class GridStore {
 public:
  /// Makes the directory when missing, locks it, and takes stock of it.
  /// Errors: kFailedPrecondition (another process has it, and one of both wants it alone),
  /// kInternal (no directory can be made or read there).
  /// `keep_free_bytes` of the disk are left to others.
  static absl::StatusOr<std::unique_ptr<GridStore>> open(
      const std::filesystem::path& root,
      std::uint64_t budget_bytes,
      std::uint64_t keep_free_bytes = 0,
      StoreSharing sharing = StoreSharing::kAlone);

  /// The directory of a server, perhaps on another host: to read from, and nothing else, but
  /// for what is found damaged. Errors: kNotFound (no such directory).
  static absl::StatusOr<std::unique_ptr<GridStore>> open_beside_server(
      const std::filesystem::path& root);

  /// Takes note of what other servers have stored or removed, unless one of them is at it just
  /// now. `list` and `stats` tell what was noted last.
  void catch_up();

  /// Whether the file is stored; if so it counts as just used.
  bool touch(const GridKey& key);

  /// Errors: kNotFound; kUnavailable, and those of the disk, where the store is shared.
  absl::StatusOr<GridLease> acquire(const GridKey& key);

  UploadState upload_state(const GridKey& key) const;

  /// A namespace's whole files in the order of their digests, at most `limit`, from the first
  /// after `after` on.
  std::vector<ListedGrid> list(const std::string& space,
                               const std::string& after,
                               std::size_t limit) const;

  StoreStats stats() const;

  /// Grids that must stay though nobody holds a lease on them, by whoever knows: asked when
  /// room is short, without any lock. To be set before uploads come. Where it fails nothing is
  /// evicted but uploads, and an upload that finds no room fails with its error.
  using Needed = std::function<absl::StatusOr<std::set<GridKey>>()>;
  void ask_before_evicting(Needed needed);

  /// Holds no more files than that, kMostStoredFiles unless it is called: to be set before
  /// uploads come.
  void limit_files(std::size_t most) { most_files_ = most; }

  /// Moves a file that was found damaged to `corrupt/`, out of the way of the next upload of
  /// it.
  void set_aside(const GridLease& grid);

  /// Begins or resumes an upload, evicting what is least used to make room for all of it.
  /// Whoever sent a part last is charged for it, as a whole while it is being sent; a restart
  /// forgets that. Errors: kAlreadyExists (stored), kAborted (being uploaded),
  /// kUnavailable (other servers took too long), kResourceExhausted (with numbers; STORE_BUSY:
  /// no room beside grids in use, STORE_HELD_BY_JOBS: nor beside grids that are needed;
  /// DISK_FULL), those of `Needed`.
  absl::StatusOr<std::unique_ptr<GridUpload>> begin_upload(const GridKey& key,
                                                           std::uint64_t size_bytes,
                                                           const Uploader& by = {});

 private:
  friend class GridUpload;
  struct Part {
    std::uint64_t size_bytes = 0;  ///< on disk, or all that was announced while it is busy
    absl::Time last_use;
    bool busy = false;
    std::string sender = {};  ///< see Uploader; empty after a restart
    bool elsewhere = false;   ///< another process sends it, or did
  };

  /// The right to change what is stored: nobody else does so meanwhile, in any process.
  struct Turn {
    std::unique_lock<std::mutex> here;
    std::optional<File> file;  ///< the journal; none where the store is not shared
  };

  /// A file that appears in the store's folders.
  struct FoundFile {
    std::filesystem::path path;
    std::uint64_t size_bytes = 0;
    absl::Time last_use;
  };

  GridStore(std::filesystem::path root,
            std::optional<StoreLock> lock,
            std::uint64_t budget_bytes,
            std::uint64_t keep_free_bytes,
            StoreSharing sharing)
      : root_(std::move(root)),
        sharing_(sharing),
        lock_(std::move(lock)),
        budget_bytes_(budget_bytes),
        keep_free_bytes_(keep_free_bytes),
        changes_(root_) {}

  bool is_shared() const { return sharing_ != StoreSharing::kAlone; }

  std::filesystem::path folder_of(std::string_view space) const;
  std::filesystem::path grid_path(const GridKey& key) const;
  std::filesystem::path part_path(const GridKey& key) const;
  static std::optional<FoundFile> inspect(const std::filesystem::path& path);
  static absl::StatusOr<std::vector<FoundFile>> files_below(
      const std::filesystem::path& folder);
  void look_again(const GridKey& key);
  absl::Status scan();
  absl::Status scan_space(const std::string& space, std::set<GridKey>& seen);
  void use(const StoredGridEntry& entry);
  void remove_aside(const GridLease& grid);

  // What follows is of stores that are shared.
  absl::StatusOr<Turn> take_turn();
  void take_note(File& turn);
  void look_at_all(File& turn);
  void note(const GridChange& change);
  void tell(Turn& turn, const GridChange& change);
  void look_at_uploads_elsewhere();
  void freshen_oldest(std::uint64_t bytes, const std::set<GridKey>& needed);
  absl::StatusOr<GridLease> acquire_shared(const GridKey& key);
  absl::StatusOr<GridLease> lease(const GridKey& key, std::shared_ptr<const File> file);
  bool is_used_elsewhere(const StoredGridEntry& entry) const;
  bool remove_unused(const StoredGridEntry& entry);
  bool remove_part(const GridKey& key);

  /// The idle grids that were used least, oldest first, when the store had given out so many
  /// leases.
  struct Evictable {
    std::deque<GridKey> grids;
    absl::Time time;
    std::uint64_t leases = 0;
    bool all = false;  ///< there is no other idle grid
  };

  std::uint64_t used_bytes() const;
  absl::StatusOr<File> reserve(const GridKey& key,
                               std::uint64_t size_bytes,
                               const Uploader& by);
  void look_before(const GridKey& key);
  absl::Status check_upload(const GridKey& key,
                            std::uint64_t size_bytes,
                            const Uploader& by) const;
  bool fits(const GridKey& key, std::uint64_t size_bytes) const;
  absl::Status check_inodes(std::size_t evictable_files) const;
  absl::Status check_disk(const GridKey& key,
                          std::uint64_t size_bytes,
                          std::uint64_t evictable_bytes) const;
  absl::StatusOr<File> take_place(Turn& turn,
                                  const GridKey& key,
                                  std::uint64_t size_bytes,
                                  const Uploader& by);
  absl::StatusOr<File> open_part(const GridKey& key) const;
  Evictable idle_grids(std::uint64_t bytes, const std::set<GridKey>& needed);
  absl::Status spare_needed(Evictable& evictable, std::set<GridKey>& needed) const;
  absl::Status check_quota(const GridKey& key,
                           std::uint64_t size_bytes,
                           const Uploader& by) const;
  const StoredGridEntry* oldest_of(Evictable& evictable) const;
  bool evict_oldest(Turn& turn, const GridKey& except_part, Evictable& evictable);

  void end_upload(const GridKey& key, std::uint64_t committed_size);
  absl::Status keep(const GridKey& key, std::uint64_t size_bytes);

  const std::filesystem::path root_;
  const StoreSharing sharing_;
  const std::optional<StoreLock>
      lock_;  ///< none beside a server, which comes and goes with files
  const std::uint64_t budget_bytes_, keep_free_bytes_;
  std::size_t most_files_ = kMostStoredFiles;
  Needed needed_;
  std::mutex turn_mutex_;     ///< before `mutex_`, as is the journal's lock
  GridChanges changes_;       ///< whoever has the turn
  mutable std::mutex mutex_;  ///< guards what follows
  std::uint64_t leases_ = 0;  ///< given out so far
  StoreStats gone_;           ///< only what is counted since the store was opened
  StoredGrids grids_;
  std::map<GridKey, Part> parts_;
};

}  // namespace tet
