#include "server/grids/grid_store.h"

#include <fcntl.h>
#include <optional>
#include <sys/stat.h>
#include <system_error>

#include <absl/strings/str_cat.h>
#include <absl/time/clock.h>

#include "proto/convert/status.h"
#include "proto/wire/sha256.h"
#include "server/grids/file_times.h"
#include "server/grids/grid_upload.h"
#include "server/grids/store_identity.h"
#include "server/ops/disk.h"
#include "server/ops/logging.h"

namespace tet {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kPartSuffix = ".part";
constexpr std::string_view kSpaces = "namespaces";

absl::Status not_stored(std::string_view digest) {
  return with_reason(absl::NotFoundError(absl::StrCat(name_of_grid(digest), " is not stored")),
                     "GRID_NOT_FOUND");
}

}  // namespace

std::optional<GridStore::FoundFile> GridStore::inspect(const fs::path& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0 || !S_ISREG(info.st_mode)) return std::nullopt;
  return FoundFile{path, static_cast<std::uint64_t>(info.st_size),
                   absl::TimeFromTimespec(info.st_mtim)};
}

/// Regular files below `folder`. Errors: kInternal.
absl::StatusOr<std::vector<GridStore::FoundFile>> GridStore::files_below(
    const fs::path& folder) {
  if (absl::Status made = make_folder(folder); !made.ok()) return made;
  std::vector<FoundFile> files;
  std::error_code error;
  for (fs::recursive_directory_iterator it(folder, error), end; !error && it != end;
       it.increment(error)) {
    if (auto file = inspect(it->path())) files.push_back(std::move(*file));
  }
  if (error) return absl::InternalError(absl::StrCat(folder.string(), ": ", error.message()));
  return files;
}

absl::StatusOr<std::unique_ptr<GridStore>> GridStore::open(const fs::path& root,
                                                           std::uint64_t budget_bytes,
                                                           std::uint64_t keep_free_bytes,
                                                           StoreSharing sharing) {
  auto lock = StoreLock::take(root, sharing);
  if (!lock.ok()) return lock.status();
  // A disk that is full is no reason not to start: whoever needs the identity makes it later.
  const auto identity = make_store_identity(root);
  if (!identity.ok() && !absl::IsResourceExhausted(identity.status())) return identity.status();
  std::unique_ptr<GridStore> store(
      new GridStore(root, *std::move(lock), budget_bytes, keep_free_bytes, sharing));
  // In a store that is shared the first turn looks at all that is there.
  const auto turn = store->take_turn();
  if (!turn.ok() && !absl::IsResourceExhausted(turn.status())) return turn.status();
  if (sharing == StoreSharing::kServers && turn.ok()) return store;
  const absl::Status status = store->scan();
  if (!status.ok()) return status;
  return store;
}

absl::StatusOr<std::unique_ptr<GridStore>> GridStore::open_beside_server(const fs::path& root) {
  std::error_code ignored;
  if (fs::is_directory(root, ignored)) {
    return std::unique_ptr<GridStore>(
        new GridStore(root, std::nullopt, 0, 0, StoreSharing::kBeside));
  }
  return absl::NotFoundError(absl::StrCat("there is no store ", root.string(),
                                          ": it is the folder of the server's --store"));
}

/// What the server has of a file now.
void GridStore::look_again(const GridKey& key) {
  const auto file = inspect(grid_path(key));
  if (!file) {
    grids_.erase(key);
  } else if (!grids_.contains(key)) {
    grids_.put({key, file->path, file->size_bytes}, file->last_use);
  }
}

/// Looks at all that is there: what is known already is left as it is.
absl::Status GridStore::scan() {
  std::set<GridKey> seen;
  absl::Status status = scan_space(std::string(kDefaultSpace), seen);
  std::error_code none;  // no such folder: no other namespaces
  for (const auto& folder : fs::directory_iterator(root_ / kSpaces, none)) {
    if (status.ok()) status = scan_space(folder.path().filename().string(), seen);
  }
  if (!status.ok()) return status;
  std::vector<GridKey> gone;
  for (const auto& [key, entry] : grids_.by_key()) {
    if (!seen.contains(key)) gone.push_back(key);
  }
  for (const GridKey& key : gone) grids_.erase(key);
  return absl::OkStatus();
}

absl::Status GridStore::scan_space(const std::string& space, std::set<GridKey>& seen) {
  const auto grids = files_below(folder_of(space) / "grids");
  if (!grids.ok()) return grids.status();
  const auto parts = files_below(folder_of(space) / "uploads");
  if (!parts.ok()) return parts.status();
  for (const FoundFile& file : *grids) {
    const GridKey key{space, file.path.filename().string()};
    if (!is_sha256_hex(key.digest) || file.path != grid_path(key)) continue;
    seen.insert(key);
    if (!grids_.contains(key)) grids_.put({key, file.path, file.size_bytes}, file.last_use);
  }
  for (const FoundFile& file : *parts) {
    const GridKey key{space, file.path.stem().string()};
    if (!is_sha256_hex(key.digest) || file.path != part_path(key)) continue;
    parts_.try_emplace(key, Part{file.size_bytes, file.last_use});
  }
  return absl::OkStatus();
}

fs::path GridStore::folder_of(std::string_view space) const {
  return space == kDefaultSpace ? root_ : root_ / kSpaces / space;
}

fs::path GridStore::grid_path(const GridKey& key) const {
  return folder_of(key.space) / "grids" / key.digest.substr(0, 2) / key.digest;
}

fs::path GridStore::part_path(const GridKey& key) const {
  return folder_of(key.space) / "uploads" / std::string(key.digest).append(kPartSuffix);
}

// The file's own time remembers the order of use across restarts; failing to set it costs only
// that.
void GridStore::use(const StoredGridEntry& entry) {
  grids_.use(entry.grid->key);
  if (is_shared()) {
    grids_.set_use(entry.grid->key, give_time(entry.grid->path, entry.last_use));
  } else {
    ::utimensat(AT_FDCWD, entry.grid->path.c_str(), nullptr, 0);
  }
}

bool GridStore::touch(const GridKey& key) {
  const std::lock_guard lock(mutex_);
  if (is_shared()) look_again(key);
  const StoredGridEntry* const found = grids_.find(key);
  if (found == nullptr) return false;
  use(*found);
  return true;
}

absl::StatusOr<GridLease> GridStore::acquire(const GridKey& key) {
  if (is_shared()) {
    auto lease = acquire_shared(key);
    return absl::IsNotFound(lease.status()) ? not_stored(key.digest) : lease;
  }
  const std::lock_guard lock(mutex_);
  const StoredGridEntry* const found = grids_.find(key);
  if (found == nullptr) return not_stored(key.digest);
  use(*found);
  grids_.lease(key, ++leases_);
  return found->grid;
}

UploadState GridStore::upload_state(const GridKey& key) const {
  const std::lock_guard lock(mutex_);
  const StoredGridEntry* const found = is_shared() ? nullptr : grids_.find(key);
  if (found != nullptr) return {found->grid->size_bytes, true};
  if (const auto whole = is_shared() ? inspect(grid_path(key)) : std::nullopt) {
    return {whole->size_bytes, true};
  }
  const auto part = inspect(part_path(key));
  return {part ? part->size_bytes : 0, false};
}

std::vector<ListedGrid> GridStore::list(const std::string& space,
                                        const std::string& after,
                                        std::size_t limit) const {
  const std::lock_guard lock(mutex_);
  std::vector<ListedGrid> listed;
  const StoredGrids::ByKey& grids = grids_.by_key();
  for (auto it = grids.upper_bound({space, after});
       it != grids.end() && it->first.space == space && listed.size() < limit; ++it) {
    listed.push_back({it->first.digest, it->second.grid->size_bytes, it->second.last_use});
  }
  return listed;
}

StoreStats GridStore::stats() const {
  const std::lock_guard lock(mutex_);
  StoreStats stats = gone_;
  stats.bytes = used_bytes();
  stats.budget_bytes = budget_bytes_;
  stats.files = grids_.by_key().size();
  stats.uploads = parts_.size();
  return stats;
}

absl::StatusOr<std::unique_ptr<GridUpload>> GridStore::begin_upload(const GridKey& key,
                                                                    std::uint64_t size_bytes,
                                                                    const Uploader& by) {
  auto file = reserve(key, size_bytes, by);
  if (!file.ok()) return file.status();
  auto upload = GridUpload::open(*this, key, size_bytes, *std::move(file));
  if (!upload.ok()) {
    const auto part = inspect(part_path(key));
    end_upload(key, part ? part->size_bytes : 0);
  }
  return upload;
}

// Several calls may have found the damage: the first one moves the file.
void GridStore::set_aside(const GridLease& grid) {
  auto turn = take_turn();
  if (!turn.ok()) return;  // whoever finds it next will
  const std::lock_guard lock(mutex_);
  const StoredGridEntry* const found = grids_.find(grid->key);
  if (found == nullptr || found->grid != grid) return;
  // Another process may have moved it, and another file of the name may have come since.
  const auto file = found->file.lock();
  if (file == nullptr || file->is_at_its_path()) {
    remove_aside(grid);
    tell(*turn, {GridChange::Kind::kGone, grid->key});
  }
  grids_.erase(grid->key);
}

void GridStore::remove_aside(const GridLease& grid) {
  const fs::path aside = folder_of(grid->key.space) / "corrupt" / grid->key.digest;
  absl::Status moved = make_folder(aside.parent_path());
  if (moved.ok()) moved = move_file(grid->path, aside);
  ++gone_.corrupt_files;
  nlohmann::ordered_json fields;
  fields["grid"] = grid->key.digest;
  fields["moved"] = moved.ok() ? aside.string() : std::string(moved.message());
  log_event(spdlog::level::err, "stored_grid_corrupt", fields);
}

/// The upload is no longer under way; what was written of it (0: nothing) waits to be resumed.
void GridStore::end_upload(const GridKey& key, std::uint64_t committed_size) {
  auto turn = take_turn();
  const std::lock_guard lock(mutex_);
  if (committed_size == 0) {
    std::error_code ignored;
    fs::remove(part_path(key), ignored);
    parts_.erase(key);
  } else {
    parts_[key] = Part{committed_size, grids_.time(), false, parts_[key].sender};
  }
  if (turn.ok()) tell(*turn, {GridChange::Kind::kPaused, key, committed_size});
}

/// A verified upload becomes a stored file.
absl::Status GridStore::keep(const GridKey& key, std::uint64_t size_bytes) {
  const fs::path path = grid_path(key);
  absl::Status status = make_folder(path.parent_path());
  auto turn = take_turn();
  if (status.ok()) status = turn.status();
  if (!status.ok()) return status;
  const std::lock_guard lock(mutex_);
  // Before it is there: what others count may be too much for a moment, and never too little.
  tell(*turn, {GridChange::Kind::kStored, key, size_bytes});
  status = move_file(part_path(key), path);
  if (!status.ok()) {
    tell(*turn, {GridChange::Kind::kGone, key});
    return status;
  }
  grids_.put({key, path, size_bytes});
  if (is_shared()) use(*grids_.find(key));
  parts_.erase(key);
  return absl::OkStatus();
}

}  // namespace tet
