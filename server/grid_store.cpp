#include "server/grid_store.h"

#include <fcntl.h>
#include <optional>
#include <sys/stat.h>
#include <system_error>

#include <absl/strings/str_cat.h>
#include <absl/time/clock.h>

#include "proto/wire/sha256.h"
#include "server/file.h"
#include "server/grid_upload.h"
#include "server/status.h"

namespace tet {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kPartSuffix = ".part";

struct FoundFile {
  fs::path path;
  std::uint64_t size_bytes = 0;
  absl::Time last_use;
};

std::optional<FoundFile> inspect(const fs::path& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0 || !S_ISREG(info.st_mode)) return std::nullopt;
  return FoundFile{path, static_cast<std::uint64_t>(info.st_size),
                   absl::TimeFromTimespec(info.st_mtim)};
}

/// Regular files below `folder`. Errors: kInternal.
absl::StatusOr<std::vector<FoundFile>> files_below(const fs::path& folder) {
  std::vector<FoundFile> files;
  std::error_code error;
  fs::create_directories(folder, error);
  for (fs::recursive_directory_iterator it(folder, error), end; !error && it != end;
       it.increment(error)) {
    if (auto file = inspect(it->path())) files.push_back(std::move(*file));
  }
  if (error) return absl::InternalError(absl::StrCat(folder.string(), ": ", error.message()));
  return files;
}

absl::Status not_stored(std::string_view digest) {
  return with_reason(absl::NotFoundError(absl::StrCat(name_of_grid(digest), " is not stored")),
                     "GRID_NOT_FOUND");
}

absl::Status no_room(std::uint64_t size_bytes, std::uint64_t used, std::uint64_t budget) {
  return with_retry(
      with_reason(absl::ResourceExhaustedError(absl::StrCat(
                      "no room for ", size_bytes, " bytes: ", used, " of the store's ", budget,
                      " bytes are in use by other calls")),
                  "STORE_BUSY"),
      absl::Seconds(5));
}

}  // namespace

absl::StatusOr<std::unique_ptr<GridStore>> GridStore::open(const fs::path& root,
                                                           std::uint64_t budget_bytes) {
  std::unique_ptr<GridStore> store(new GridStore(root, budget_bytes));
  const absl::Status status = store->scan();
  if (!status.ok()) return status;
  return store;
}

absl::Status GridStore::scan() {
  const auto grids = files_below(root_ / "grids");
  if (!grids.ok()) return grids.status();
  const auto parts = files_below(root_ / "uploads");
  if (!parts.ok()) return parts.status();
  for (const FoundFile& file : *grids) {
    const std::string digest = file.path.filename().string();
    if (!is_sha256_hex(digest) || file.path != grid_path(digest)) continue;
    auto grid = std::make_shared<StoredGrid>(StoredGrid{digest, file.path, file.size_bytes});
    grids_[digest] = Entry{std::move(grid), file.last_use};
  }
  for (const FoundFile& file : *parts) {
    const std::string digest = file.path.stem().string();
    if (!is_sha256_hex(digest) || file.path != part_path(digest)) continue;
    parts_[digest] = Part{file.size_bytes, file.last_use};
  }
  return absl::OkStatus();
}

fs::path GridStore::grid_path(std::string_view digest) const {
  return root_ / "grids" / digest.substr(0, 2) / digest;
}

fs::path GridStore::part_path(std::string_view digest) const {
  return root_ / "uploads" / std::string(digest).append(kPartSuffix);
}

// The file's own time remembers the order of use across restarts; failing to set it costs only
// that.
void GridStore::use(Entry& entry) {
  entry.last_use = absl::Now();
  ::utimensat(AT_FDCWD, entry.grid->path.c_str(), nullptr, 0);
}

bool GridStore::touch(std::string_view digest) {
  const std::lock_guard lock(mutex_);
  const auto found = grids_.find(digest);
  if (found == grids_.end()) return false;
  use(found->second);
  return true;
}

absl::StatusOr<GridLease> GridStore::acquire(std::string_view digest) {
  const std::lock_guard lock(mutex_);
  const auto found = grids_.find(digest);
  if (found == grids_.end()) return not_stored(digest);
  use(found->second);
  return found->second.grid;
}

UploadState GridStore::upload_state(std::string_view digest) const {
  const std::lock_guard lock(mutex_);
  if (const auto grid = grids_.find(digest); grid != grids_.end()) {
    return {grid->second.grid->size_bytes, true};
  }
  const auto part = inspect(part_path(digest));
  return {part ? part->size_bytes : 0, false};
}

std::vector<ListedGrid> GridStore::list(std::string_view after, std::size_t limit) const {
  const std::lock_guard lock(mutex_);
  std::vector<ListedGrid> listed;
  for (auto it = grids_.upper_bound(after); it != grids_.end() && listed.size() < limit; ++it) {
    listed.push_back({it->first, it->second.grid->size_bytes, it->second.last_use});
  }
  return listed;
}

absl::StatusOr<std::unique_ptr<GridUpload>> GridStore::begin_upload(std::string_view digest,
                                                                    std::uint64_t size_bytes,
                                                                    const Uploader& by) {
  const absl::Status reserved = reserve(digest, size_bytes, by);
  if (!reserved.ok()) return reserved;
  auto upload = GridUpload::open(*this, std::string(digest), size_bytes, part_path(digest));
  if (!upload.ok()) {
    const auto part = inspect(part_path(digest));
    end_upload(std::string(digest), part ? part->size_bytes : 0);
  }
  return upload;
}

std::uint64_t GridStore::used_bytes() const {
  std::uint64_t used = 0;
  for (const auto& [digest, entry] : grids_) used += entry.grid->size_bytes;
  for (const auto& [digest, part] : parts_) used += part.size_bytes;
  return used;
}

/// Marks the upload as under way, with room for all of it.
absl::Status GridStore::reserve(std::string_view digest,
                                std::uint64_t size_bytes,
                                const Uploader& by) {
  if (size_bytes > budget_bytes_)
    return over_limit("grid file, bytes", size_bytes, budget_bytes_);
  const std::lock_guard lock(mutex_);
  if (grids_.contains(digest)) {
    return absl::AlreadyExistsError(absl::StrCat(name_of_grid(digest), " is stored"));
  }
  const auto found = parts_.find(digest);
  if (found != parts_.end() && found->second.busy) {
    return with_retry(
        with_reason(absl::AbortedError(absl::StrCat(name_of_grid(digest),
                                                    " is being uploaded by another call")),
                    "UPLOAD_IN_PROGRESS"),
        absl::Seconds(1));
  }
  if (auto status = check_quota(digest, size_bytes, by); !status.ok()) return status;
  const std::uint64_t held = found == parts_.end() ? 0 : found->second.size_bytes;
  while (used_bytes() - held + size_bytes > budget_bytes_) {
    if (!evict_oldest(digest)) return no_room(size_bytes, used_bytes() - held, budget_bytes_);
  }
  parts_[std::string(digest)] = Part{size_bytes, absl::Now(), true, by.name};
  return absl::OkStatus();
}

absl::Status GridStore::check_quota(std::string_view digest,
                                    std::uint64_t size_bytes,
                                    const Uploader& by) const {
  std::uint64_t bytes = size_bytes;
  for (const auto& [part_digest, part] : parts_) {
    if (part.sender == by.name && part_digest != digest) bytes += part.size_bytes;
  }
  if (bytes <= by.max_bytes) return absl::OkStatus();
  return over_quota(by.name, "bytes of unfinished uploads", bytes, by.max_bytes);
}

/// Removes the least recently used of the grids that nobody holds and the uploads nobody sends.
bool GridStore::evict_oldest(std::string_view except_part) {
  auto oldest_grid = grids_.end();
  for (auto it = grids_.begin(); it != grids_.end(); ++it) {
    if (it->second.in_use()) continue;
    if (oldest_grid == grids_.end() || it->second.last_use < oldest_grid->second.last_use) {
      oldest_grid = it;
    }
  }
  auto oldest_part = parts_.end();
  for (auto it = parts_.begin(); it != parts_.end(); ++it) {
    if (it->second.busy || it->first == except_part) continue;
    if (oldest_part == parts_.end() || it->second.last_use < oldest_part->second.last_use) {
      oldest_part = it;
    }
  }
  std::error_code ignored;  // a file that is gone already has been evicted by someone else
  if (oldest_part != parts_.end() &&
      (oldest_grid == grids_.end() ||
       oldest_part->second.last_use < oldest_grid->second.last_use)) {
    fs::remove(part_path(oldest_part->first), ignored);
    parts_.erase(oldest_part);
    return true;
  }
  if (oldest_grid == grids_.end()) return false;
  fs::remove(oldest_grid->second.grid->path, ignored);
  grids_.erase(oldest_grid);
  return true;
}

/// The upload is no longer under way; what was written of it (0: nothing) waits to be resumed.
void GridStore::end_upload(const std::string& digest, std::uint64_t committed_size) {
  const std::lock_guard lock(mutex_);
  if (committed_size == 0) {
    std::error_code ignored;
    fs::remove(part_path(digest), ignored);
    parts_.erase(digest);
  } else {
    parts_[digest] = Part{committed_size, absl::Now(), false, parts_[digest].sender};
  }
}

/// A verified upload becomes a stored file.
absl::Status GridStore::keep(const std::string& digest, std::uint64_t size_bytes) {
  const fs::path path = grid_path(digest);
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  const std::lock_guard lock(mutex_);
  const absl::Status moved = move_file(part_path(digest), path);
  if (!moved.ok()) return moved;
  auto grid = std::make_shared<StoredGrid>(StoredGrid{digest, path, size_bytes});
  grids_[digest] = Entry{std::move(grid), absl::Now()};
  parts_.erase(digest);
  return absl::OkStatus();
}

}  // namespace tet
