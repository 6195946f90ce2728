// Grid files on disk, named by their SHA-256, under a size budget.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>
#include <absl/time/time.h>

namespace tet {

class GridUpload;

/// A whole, verified file. It is not evicted while anyone holds a lease on it.
struct StoredGrid {
  std::string digest;
  std::filesystem::path path;
  std::uint64_t size_bytes = 0;
};
using GridLease = std::shared_ptr<const StoredGrid>;

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
};

/// A content-addressed directory: `grids/ab/{sha256}` for whole files and
/// `uploads/{sha256}.part` for those under way. Both survive a restart; a whole file appears by
/// an atomic rename only.
///
/// Digests are 64 lower-case hexadecimal digits; the caller has checked that. One process at a
/// time may use a directory. Thread safety: every member may be called from any thread.
class GridStore {
 public:
  /// Makes the directory when missing and takes stock of it.
  /// Errors: kInternal (no directory can be made or read there).
  static absl::StatusOr<std::unique_ptr<GridStore>> open(const std::filesystem::path& root,
                                                         std::uint64_t budget_bytes);

  /// Whether the file is stored; if so it counts as just used.
  bool touch(std::string_view digest);

  /// Errors: kNotFound.
  absl::StatusOr<GridLease> acquire(std::string_view digest);

  UploadState upload_state(std::string_view digest) const;

  /// Whole files in the order of their digests, at most `limit`, from the first after `after`
  /// on.
  std::vector<ListedGrid> list(std::string_view after, std::size_t limit) const;

  /// Begins or resumes an upload, evicting what is least used to make room for all of it.
  /// Whoever sent a part last is charged for it, as a whole while it is being sent; a restart
  /// forgets that. Errors: kAlreadyExists (stored), kAborted (being uploaded),
  /// kResourceExhausted (with numbers).
  absl::StatusOr<std::unique_ptr<GridUpload>> begin_upload(std::string_view digest,
                                                           std::uint64_t size_bytes,
                                                           const Uploader& by = {});

 private:
  friend class GridUpload;
  struct Entry {
    std::shared_ptr<StoredGrid> grid;
    absl::Time last_use;
    bool in_use() const { return grid.use_count() > 1; }
  };
  struct Part {
    std::uint64_t size_bytes = 0;  ///< on disk, or all that was announced while it is busy
    absl::Time last_use;
    bool busy = false;
    std::string sender = {};  ///< see Uploader; empty after a restart
  };

  GridStore(std::filesystem::path root, std::uint64_t budget_bytes)
      : root_(std::move(root)), budget_bytes_(budget_bytes) {}

  std::filesystem::path grid_path(std::string_view digest) const;
  std::filesystem::path part_path(std::string_view digest) const;
  absl::Status scan();
  void use(Entry& entry);

  std::uint64_t used_bytes() const;
  absl::Status reserve(std::string_view digest, std::uint64_t size_bytes, const Uploader& by);
  absl::Status check_quota(std::string_view digest,
                           std::uint64_t size_bytes,
                           const Uploader& by) const;
  bool evict_oldest(std::string_view except_part);

  void end_upload(const std::string& digest, std::uint64_t committed_size);
  absl::Status keep(const std::string& digest, std::uint64_t size_bytes);

  const std::filesystem::path root_;
  const std::uint64_t budget_bytes_;
  mutable std::mutex mutex_;
  std::map<std::string, Entry, std::less<>> grids_;
  std::map<std::string, Part, std::less<>> parts_;
};

}  // namespace tet
