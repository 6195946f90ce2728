// GridStore: room for uploads, and who has to go for it.
#include <algorithm>
#include <system_error>

#include <absl/strings/str_cat.h>
#include <absl/time/clock.h>

#include "proto/convert/status.h"
#include "proto/wire/sha256.h"
#include "server/grids/grid_store.h"
#include "server/ops/disk.h"

namespace tet {

namespace fs = std::filesystem;

namespace {

constexpr absl::Duration kAskAgain = absl::Seconds(5);

/// Jobs are asked once for at least so many grids, which may all be needed.
constexpr std::size_t kFewGrids = 64;

// How much the others use is not for everybody to know.
absl::Status no_room(std::uint64_t size_bytes,
                     std::uint64_t budget,
                     const std::string& who,
                     std::string_view reason) {
  return with_retry(with_reason(absl::ResourceExhaustedError(absl::StrCat(
                                    "no room for ", size_bytes, " bytes beside what ", who,
                                    " use of the store's ", budget)),
                                reason),
                    kAskAgain);
}

absl::Status in_progress(const GridKey& key) {
  return with_retry(
      with_reason(absl::AbortedError(absl::StrCat(name_of_grid(key.digest),
                                                  " is being uploaded by another call")),
                  "UPLOAD_IN_PROGRESS"),
      absl::Seconds(1));
}

}  // namespace

void GridStore::ask_before_evicting(Needed needed) { needed_ = std::move(needed); }

std::uint64_t GridStore::used_bytes() const {
  std::uint64_t used = grids_.bytes();
  for (const auto& [key, part] : parts_) used += part.size_bytes;
  return used;
}

/// Marks the upload as under way, with room for all of it, and opens its part.
absl::StatusOr<File> GridStore::reserve(const GridKey& key,
                                        std::uint64_t size_bytes,
                                        const Uploader& by) {
  if (size_bytes > budget_bytes_)
    return over_limit("grid file, bytes", size_bytes, budget_bytes_);
  std::set<GridKey> needed;
  while (true) {
    Evictable evictable;
    {
      auto turn = take_turn();
      if (!turn.ok()) return turn.status();
      const std::lock_guard lock(mutex_);
      look_before(key);
      if (auto status = check_upload(key, size_bytes, by); !status.ok()) return status;
      if (auto disk = check_disk(key, size_bytes, used_bytes()); !disk.ok()) return disk;
      const std::size_t files = grids_.by_key().size() + parts_.size();
      if (auto inodes = check_inodes(files); !inodes.ok()) return inodes;
      if (fits(key, size_bytes)) return take_place(*turn, key, size_bytes, by);
      evictable = idle_grids(size_bytes, needed);
    }
    // Whoever submits a job holds its grid until the job is stored. So a grid that was idle
    // before the jobs are asked, that none of them needs, and that nobody took since is needed
    // by none.
    const absl::Status asked = spare_needed(evictable, needed);
    auto turn = take_turn();
    if (!turn.ok()) return turn.status();
    const std::lock_guard lock(mutex_);
    look_before(key);
    if (auto status = check_upload(key, size_bytes, by); !status.ok()) return status;
    while (!fits(key, size_bytes) && evict_oldest(*turn, key, evictable)) continue;
    if (fits(key, size_bytes)) return take_place(*turn, key, size_bytes, by);
    if (!asked.ok()) return asked;
    if (!evictable.all) continue;
    if (auto disk = check_disk(key, size_bytes, 0); !disk.ok()) return disk;
    if (auto inodes = check_inodes(0); !inodes.ok()) return inodes;
    if (needed.empty()) return no_room(size_bytes, budget_bytes_, "other calls", "STORE_BUSY");
    return no_room(size_bytes, budget_bytes_, "other calls and jobs that are not finished",
                   "STORE_HELD_BY_JOBS");
  }
}

absl::Status GridStore::check_upload(const GridKey& key,
                                     std::uint64_t size_bytes,
                                     const Uploader& by) const {
  if (grids_.contains(key)) {
    return absl::AlreadyExistsError(absl::StrCat(name_of_grid(key.digest), " is stored"));
  }
  const auto found = parts_.find(key);
  if (found != parts_.end() && found->second.busy) {
    return in_progress(key);
  }
  return check_quota(key, size_bytes, by);
}

absl::Status GridStore::check_quota(const GridKey& key,
                                    std::uint64_t size_bytes,
                                    const Uploader& by) const {
  std::uint64_t bytes = size_bytes, files = 1;
  for (const auto& [part_key, part] : parts_) {
    if (part.sender != by.name || part_key == key) continue;
    bytes += part.size_bytes;
    ++files;
  }
  if (bytes > by.max_bytes) {
    return over_quota(by.name, "bytes of unfinished uploads", bytes, by.max_bytes);
  }
  if (files <= by.max_files) return absl::OkStatus();
  return over_quota(by.name, "unfinished uploads", files, by.max_files);
}

bool GridStore::fits(const GridKey& key, std::uint64_t size_bytes) const {
  const auto found = parts_.find(key);
  const std::uint64_t held = found == parts_.end() ? 0 : found->second.size_bytes;
  const std::size_t others = grids_.by_key().size() + parts_.size() - parts_.count(key);
  return used_bytes() - held + size_bytes <= budget_bytes_ && others < most_files_ &&
         check_inodes(0).ok() && check_disk(key, size_bytes, 0).ok();
}

/// Whether the disk takes another file, if `evictable_files` went: it may run out of them long
/// before it is full. A disk that does not tell does.
absl::Status GridStore::check_inodes(std::size_t evictable_files) const {
  const auto free = free_disk_files(root_);
  if (!free || *free + evictable_files > 0) return absl::OkStatus();
  return with_reason(absl::ResourceExhaustedError("no room on the disk for another file"),
                     "DISK_FULL");
}

/// Whether the disk has room for what is still to come of this upload and of all that are under
/// way, if `evictable_bytes` went. A disk that does not tell has.
absl::Status GridStore::check_disk(const GridKey& key,
                                   std::uint64_t size_bytes,
                                   std::uint64_t evictable_bytes) const {
  const auto free = free_disk_bytes(root_);
  if (!free) return absl::OkStatus();
  const auto rest_of = [&](const GridKey& part, std::uint64_t whole) {
    std::error_code gone;
    const std::uint64_t written = fs::file_size(part_path(part), gone);
    return gone ? whole : whole - std::min(whole, written);
  };
  std::uint64_t coming = rest_of(key, size_bytes);
  for (const auto& [other, part] : parts_) {
    if (part.busy && other != key) coming += rest_of(other, part.size_bytes);
  }
  if (*free + evictable_bytes >= coming + keep_free_bytes_) return absl::OkStatus();
  return no_disk_for(size_bytes, *free, keep_free_bytes_);
}

absl::StatusOr<File> GridStore::take_place(Turn& turn,
                                           const GridKey& key,
                                           std::uint64_t size_bytes,
                                           const Uploader& by) {
  auto part = open_part(key);
  if (!part.ok()) return part;
  parts_[key] = Part{size_bytes, grids_.time(), true, by.name};
  tell(turn, {GridChange::Kind::kBegun, key, size_bytes, by.name});
  return part;
}

/// The part of an upload, locked where the store is shared.
absl::StatusOr<File> GridStore::open_part(const GridKey& key) const {
  const fs::path path = part_path(key);
  std::error_code error;  // what it hinders fails by itself
  fs::create_directories(path.parent_path(), error);
  auto part = open_file(path, O_RDWR | O_CREAT);
  if (!part.ok() || !is_shared()) return part;
  const auto locked = part->lock(FileLock::kAlone);
  if (!locked.ok()) return locked.status();
  if (!*locked) return in_progress(key);
  return part;
}

/// What other processes may have done with the file, and with the uploads they had.
void GridStore::look_before(const GridKey& key) {
  if (!is_shared()) return;
  look_again(key);
  look_at_uploads_elsewhere();
}

/// Enough of them to make room for `bytes`, if there are.
GridStore::Evictable GridStore::idle_grids(std::uint64_t bytes,
                                           const std::set<GridKey>& needed) {
  if (is_shared()) freshen_oldest(bytes, needed);
  Evictable idle{{}, grids_.time(), leases_, /*all=*/true};
  std::uint64_t found_bytes = 0;
  grids_.oldest_first([&](const StoredGridEntry& entry) {
    if (entry.in_use() || needed.contains(entry.grid->key)) return true;
    // Its time tells only when it was taken: whoever has it still may give it to a job next.
    if (is_used_elsewhere(entry)) return true;
    idle.grids.push_back(entry.grid->key);
    found_bytes += entry.grid->size_bytes;
    idle.all = idle.grids.size() < kFewGrids || found_bytes < bytes;
    return idle.all;
  });
  return idle;
}

/// Takes away those that somebody needs who has no lease; all if that cannot be told.
absl::Status GridStore::spare_needed(Evictable& evictable, std::set<GridKey>& needed) const {
  if (!needed_ || evictable.grids.empty()) return absl::OkStatus();
  auto told = needed_();
  if (!told.ok()) {
    evictable.grids.clear();
    return told.status();
  }
  std::erase_if(evictable.grids, [&](const GridKey& key) {
    return told->contains(key) && needed.insert(key).second;
  });
  return absl::OkStatus();
}

/// The first that is still there and that nobody has touched since; those before it are
/// dropped.
const StoredGridEntry* GridStore::oldest_of(Evictable& evictable) const {
  for (; !evictable.grids.empty(); evictable.grids.pop_front()) {
    const StoredGridEntry* const entry = grids_.find(evictable.grids.front());
    if (entry == nullptr || entry->in_use()) continue;
    if (entry->last_lease <= evictable.leases && entry->last_use <= evictable.time)
      return entry;
  }
  return nullptr;
}

/// Removes what was used least of the grids that may be evicted and the uploads nobody sends.
bool GridStore::evict_oldest(Turn& turn, const GridKey& except_part, Evictable& evictable) {
  const StoredGridEntry* const oldest_grid = oldest_of(evictable);
  auto oldest_part = parts_.end();
  for (auto it = parts_.begin(); it != parts_.end(); ++it) {
    if (it->second.busy || it->first == except_part) continue;
    if (oldest_part == parts_.end() || it->second.last_use < oldest_part->second.last_use) {
      oldest_part = it;
    }
  }
  if (oldest_part != parts_.end() &&
      (oldest_grid == nullptr || oldest_part->second.last_use < oldest_grid->last_use)) {
    const GridKey key = oldest_part->first;
    if (!remove_part(key)) return true;  // it is busy, as is noted now
    parts_.erase(key);
    ++gone_.evicted_uploads;
    tell(turn, {GridChange::Kind::kPaused, key});
    return true;
  }
  if (oldest_grid == nullptr) return false;
  const GridKey key = oldest_grid->grid->key;
  evictable.grids.pop_front();
  if (!remove_unused(*oldest_grid)) return true;  // somebody took it meanwhile
  grids_.erase(key);
  ++gone_.evicted_files;
  tell(turn, {GridChange::Kind::kGone, key});
  return true;
}

}  // namespace tet
