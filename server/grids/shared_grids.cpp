// GridStore: what it takes to share a store with other processes.
#include <chrono>
#include <system_error>
#include <thread>
#include <utility>

#include <absl/strings/str_cat.h>

#include "proto/convert/status.h"
#include "proto/wire/sha256.h"
#include "server/grids/grid_store.h"
#include "server/ops/disk.h"

namespace tet {

namespace fs = std::filesystem;

namespace {

// A file that is being evicted, or was just uploaded, is locked for a moment.
constexpr int kLockAttempts = 500;
constexpr std::chrono::milliseconds kLockPause{2};

// Times of use change while they are looked at.
constexpr int kFreshenRounds = 16;
constexpr std::size_t kFreshenAtLeast = 64;

absl::Status locked_for_too_long(const GridKey& key) {
  return with_retry(absl::UnavailableError(absl::StrCat(
                        name_of_grid(key.digest), " has been locked by another process for ",
                        (kLockAttempts * kLockPause).count(), " ms")),
                    absl::Seconds(1));
}

/// A file with a shared lock; null if somebody has it alone or it is another file by now.
absl::StatusOr<std::shared_ptr<const File>> share(const fs::path& path) {
  auto file = open_file(path, O_RDONLY);
  if (!file.ok()) return file.status();
  const auto locked = file->lock(FileLock::kSharedIfFree);
  if (!locked.ok()) return locked.status();
  if (!*locked || !file->is_at_its_path()) return nullptr;
  return std::make_shared<const File>(*std::move(file));
}

/// A lease's own: the file is closed before the store may think that it is idle.
struct HeldGrid {
  std::shared_ptr<const StoredGrid> grid;
  std::shared_ptr<const File> file;
};

}  // namespace

// A worker removes what it finds damaged, and keeps no account.
absl::StatusOr<GridStore::Turn> GridStore::take_turn() {
  Turn turn;
  if (!is_shared()) return turn;
  turn.here = std::unique_lock(turn_mutex_);
  auto file = changes_.take_turn();
  if (!file.ok()) return file.status();
  turn.file = *std::move(file);
  if (sharing_ == StoreSharing::kServers) take_note(*turn.file);
  return turn;
}

void GridStore::catch_up() {
  if (sharing_ != StoreSharing::kServers) return;
  const std::unique_lock here(turn_mutex_, std::try_to_lock);
  if (!here.owns_lock()) return;
  auto file = changes_.try_turn();
  if (file.ok() && file->has_value()) take_note(**file);
}

void GridStore::take_note(File& turn) {
  const std::lock_guard lock(mutex_);
  if (const auto news = changes_.news(turn)) {
    for (const GridChange& change : *news) note(change);
  } else {
    look_at_all(turn);
  }
  if (!changes_.is_long()) return;
  look_at_uploads_elsewhere();
  std::vector<GridChange> under_way;
  for (const auto& [key, part] : parts_) {
    if (!part.busy) continue;
    under_way.push_back({GridChange::Kind::kBegun, key, part.size_bytes, part.sender});
  }
  changes_.begin_anew(turn, under_way);
}

/// The folders tell what there is, locks who is at it, and the journal how large it will be.
void GridStore::look_at_all(File& turn) {
  std::erase_if(parts_,
                [](const auto& part) { return !part.second.busy || part.second.elsewhere; });
  scan().IgnoreError();  // what could not be seen is found when it is asked for
  for (const GridChange& change : changes_.read_anew(turn)) {
    if (parts_.contains(change.key)) note(change);
  }
  for (auto& [key, part] : parts_) {
    if (!part.busy) part.busy = part.elsewhere = true;  // until its lock is looked at
  }
  look_at_uploads_elsewhere();
}

/// Another process has done this. What is our own cannot be another's: it is locked.
void GridStore::note(const GridChange& change) {
  const auto part = parts_.find(change.key);
  if (part != parts_.end() && part->second.busy && !part->second.elsewhere) return;
  switch (change.kind) {
    case GridChange::Kind::kStored:
      parts_.erase(change.key);
      if (grids_.contains(change.key)) return;
      grids_.put({change.key, grid_path(change.key), change.size_bytes});
      return;
    case GridChange::Kind::kGone:
      grids_.erase(change.key);
      return;
    case GridChange::Kind::kBegun:
      parts_[change.key] =
          Part{change.size_bytes, grids_.time(), true, change.sender, /*elsewhere=*/true};
      return;
    case GridChange::Kind::kPaused:
      if (change.size_bytes == 0) {
        parts_.erase(change.key);
      } else {
        parts_[change.key] =
            Part{change.size_bytes, grids_.time(), false, parts_[change.key].sender};
      }
      return;
  }
}

void GridStore::tell(Turn& turn, const GridChange& change) {
  if (turn.file && sharing_ == StoreSharing::kServers) changes_.tell(*turn.file, change);
}

/// Those whose process has died are nobody's any more, and have the size that they have; those
/// of which nothing came are gone.
void GridStore::look_at_uploads_elsewhere() {
  for (auto it = parts_.begin(); it != parts_.end();) {
    const auto here = it++;
    Part& part = here->second;
    if (!part.busy || !part.elsewhere) continue;
    const fs::path path = part_path(here->first);
    const auto file = share(path);
    if (absl::IsNotFound(file.status())) {
      parts_.erase(here);
    } else if (file.ok() && *file != nullptr) {
      part.busy = part.elsewhere = false;
      part.size_bytes = (*file)->size().value_or(part.size_bytes);
      if (part.size_bytes > 0) continue;
      std::error_code ignored;
      fs::remove(path, ignored);
      parts_.erase(here);
    }
  }
}

/// Reads again when the oldest were used, until enough of them are as they are remembered.
void GridStore::freshen_oldest(std::uint64_t bytes, const std::set<GridKey>& needed) {
  for (int round = 0; round < kFreshenRounds; ++round) {
    std::vector<std::pair<GridKey, std::optional<FoundFile>>> changed;
    std::uint64_t idle_bytes = 0;
    std::size_t idle = 0;
    grids_.oldest_first([&](const StoredGridEntry& entry) {
      const auto file = inspect(entry.grid->path);
      if (!file || file->last_use != entry.last_use)
        changed.emplace_back(entry.grid->key, file);
      if (entry.in_use() || needed.contains(entry.grid->key)) return true;
      idle_bytes += entry.grid->size_bytes;
      return ++idle < kFreshenAtLeast || idle_bytes < bytes;
    });
    if (changed.empty()) return;
    for (const auto& [key, file] : changed) {
      if (file) {
        grids_.set_use(key, file->last_use);
      } else {
        grids_.erase(key);
      }
    }
  }
}

absl::StatusOr<GridLease> GridStore::acquire_shared(const GridKey& key) {
  for (int attempt = 0; attempt < kLockAttempts; ++attempt) {
    std::shared_ptr<const File> file;
    {
      const std::lock_guard lock(mutex_);
      look_again(key);
      const StoredGridEntry* const found = grids_.find(key);
      if (found == nullptr) return absl::NotFoundError("no such file");
      file = found->file.lock();
    }
    if (file == nullptr || !file->is_at_its_path()) {
      auto shared = share(grid_path(key));
      if (!shared.ok()) return shared.status();
      file = *std::move(shared);
    }
    if (file != nullptr) return lease(key, std::move(file));
    std::this_thread::sleep_for(kLockPause);
  }
  return locked_for_too_long(key);
}

absl::StatusOr<GridLease> GridStore::lease(const GridKey& key,
                                           std::shared_ptr<const File> file) {
  const std::lock_guard lock(mutex_);
  look_again(key);
  const StoredGridEntry* const found = grids_.find(key);
  if (found == nullptr) return absl::NotFoundError("no such file");
  use(*found);
  grids_.lease(key, ++leases_);
  grids_.hold(key, file);
  const auto held = std::make_shared<const HeldGrid>(HeldGrid{found->grid, std::move(file)});
  return GridLease(held, held->grid.get());
}

/// Whether another process has it now. Whoever takes it later says so in the file's time.
bool GridStore::is_used_elsewhere(const StoredGridEntry& entry) const {
  if (!is_shared()) return false;
  auto file = open_file(entry.grid->path, O_RDWR);
  if (!file.ok()) return false;  // it is gone, or removing it will tell why not
  const auto alone = file->lock(FileLock::kAlone);
  return !alone.ok() || !*alone;
}

/// False if another process uses it, or has used it since its time was read.
bool GridStore::remove_unused(const StoredGridEntry& entry) {
  const fs::path& path = entry.grid->path;
  std::error_code ignored;  // a file that is gone already has been evicted by someone else
  if (!is_shared()) {
    fs::remove(path, ignored);
    return true;
  }
  auto file = open_file(path, O_RDWR);
  if (absl::IsNotFound(file.status())) return true;
  if (!file.ok()) return false;
  const auto alone = file->lock(FileLock::kAlone);
  if (!alone.ok() || !*alone || !file->is_at_its_path()) return false;
  const auto now = inspect(path);
  if (!now || now->last_use != entry.last_use) return false;
  return fs::remove(path, ignored);
}

/// False if another process sends it, which is noted then.
bool GridStore::remove_part(const GridKey& key) {
  const fs::path path = part_path(key);
  std::error_code ignored;
  if (is_shared()) {
    const auto file = share(path);
    if (file.ok() && *file == nullptr) {
      parts_[key].busy = parts_[key].elsewhere = true;
      return false;
    }
    fs::remove(path, ignored);
    return true;
  }
  fs::remove(path, ignored);
  return true;
}

}  // namespace tet
