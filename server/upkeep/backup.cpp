#include "server/upkeep/backup.h"

#include <set>
#include <string>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <vector>

#include <absl/strings/str_cat.h>
#include <absl/time/clock.h>
#include <absl/time/time.h>
#include <nlohmann/json.hpp>

#include "core/base/posix/atomic_file.h"
#include "core/base/posix/folder.h"
#include "proto/wire/sha256.h"
#include "server/grids/store_identity.h"
#include "server/grids/store_lock.h"
#include "server/jobs/store/sqlite_backup.h"
#include "server/upkeep/store_files.h"

namespace tet {

namespace {

namespace fs = std::filesystem;

constexpr char kDone[] = "backup.json";  ///< written last: a backup without it is none
constexpr char kJobs[] = "jobs.sqlite";

// A grid that a job needs is only missed if it came and went between two looks.
constexpr int kMostLooks = 5;

/// Whether the backup has this file as the store has it now. What is named after its content
/// needs no more than its size; the others are replaced as a whole, with another time.
bool is_same(const fs::path& ours, const fs::path& theirs, FileKind kind) {
  struct stat a {
  }, b{};
  if (::stat(ours.c_str(), &a) != 0 || ::stat(theirs.c_str(), &b) != 0) return false;
  if (a.st_dev == b.st_dev && a.st_ino == b.st_ino) return true;
  if (a.st_size != b.st_size) return false;
  const bool is_named_so = kind == FileKind::kNever &&
                           is_sha256_hex(theirs.filename().string()) &&
                           theirs.parent_path().filename() != "plans";
  return is_named_so ||
         (a.st_mtim.tv_sec == b.st_mtim.tv_sec && a.st_mtim.tv_nsec == b.st_mtim.tv_nsec);
}

/// Takes over all files that are not there yet, and says which the store has.
absl::Status take_files(const fs::path& from,
                        const fs::path& to,
                        std::set<fs::path>& there,
                        BackupCounts& counts) {
  return for_each_store_file(from, [&](const StoreFile& file) {
    if (file.path == kStoreIdentityFile) return absl::OkStatus();
    there.insert(file.path);
    if (is_same(to / file.path, from / file.path, file.kind)) return absl::OkStatus();
    const absl::Status taken = file.kind == FileKind::kNever
                                   ? link_or_copy(from / file.path, to / file.path)
                                   : copy_whole_file(from / file.path, to / file.path);
    if (absl::IsNotFound(taken)) return absl::OkStatus();  // evicted in the meantime
    if (taken.ok()) ++counts.new_files;
    return taken;
  });
}

/// Whether the backup has every grid that an unfinished job of its database reads.
absl::StatusOr<bool> has_inputs(const fs::path& backup, std::set<fs::path>& needed) {
  const auto inputs = inputs_of_sqlite(backup / kJobs);
  if (!inputs.ok()) return inputs.status();
  bool all = true;
  for (const JobInput& input : *inputs) {
    if (!is_sha256_hex(input.name)) continue;
    const fs::path file = grid_file(input.space, input.name);
    needed.insert(file);
    std::error_code ignored;
    all = all && fs::exists(backup / file, ignored);
  }
  return all;
}

/// Removes what the store has no more; what its jobs read stays.
absl::Status drop_gone(const fs::path& backup,
                       const std::set<fs::path>& there,
                       BackupCounts& counts) {
  std::vector<fs::path> gone;
  const absl::Status looked = for_each_store_file(backup, [&](const StoreFile& file) {
    if (file.path == kStoreIdentityFile) return absl::OkStatus();
    ++counts.files;
    if (!there.contains(file.path)) gone.push_back(file.path);
    return absl::OkStatus();
  });
  if (!looked.ok()) return looked;
  for (const fs::path& file : gone) {
    std::error_code ignored;
    if (!fs::remove(backup / file, ignored)) continue;
    ++counts.gone_files;
    --counts.files;
  }
  return absl::OkStatus();
}

absl::Status sync_all(const fs::path& folder) {
  const auto file = File::open(folder, O_RDONLY | O_DIRECTORY, io_error);
  if (!file.ok()) return file.status();
  return ::syncfs(file->descriptor().number()) == 0 ? absl::OkStatus()
                                                    : io_error("write to", folder);
}

absl::Status finish(const fs::path& backup, const std::string& identity, bool has_jobs) {
  nlohmann::ordered_json done;
  done["store"] = identity;
  done["time"] = absl::FormatTime(absl::RFC3339_sec, absl::Now(), absl::UTCTimeZone());
  done["version"] = TETSTREAM_VERSION;
  done["jobs"] = has_jobs;
  if (auto status = sync_all(backup); !status.ok()) return status;
  return write_text_file((backup / kDone).string(), done.dump(2) + "\n");
}

/// A folder that this store was backed up to before, or an empty one.
absl::Status take_backup_folder(const fs::path& backup, const std::string& identity) {
  if (auto made = make_folder(backup, 0750, io_error); !made.ok()) return made;
  std::error_code error;
  const auto before = read_store_identity(backup);
  if (before.ok() && *before != identity) {
    return absl::FailedPreconditionError(
        absl::StrCat(backup.string(), " is the backup of store ", *before,
                     ", and this is store ", identity, ": choose another folder"));
  }
  if (before.ok()) return absl::OkStatus();
  if (!fs::is_empty(backup, error)) {
    return absl::FailedPreconditionError(
        absl::StrCat(backup.string(), " is neither empty nor a backup: choose another folder"));
  }
  return write_text_file((backup / kStoreIdentityFile).string(), identity + "\n");
}

absl::Status check_empty(const fs::path& store, const fs::path& jobs) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(store, error)) {
    if (entry.path().filename() == "lock") continue;
    return absl::FailedPreconditionError(absl::StrCat(
        store.string(), " is not empty: ", entry.path().filename().string(), " is there"));
  }
  if (jobs.empty()) return absl::OkStatus();
  if (fs::exists(jobs, error)) {
    return absl::FailedPreconditionError(
        absl::StrCat(jobs.string(), " is there already: move it away"));
  }
  // SQLite would take them for the restored file's own, and mix two databases.
  for (const char* const ending : {"-wal", "-shm", "-journal"}) {
    const fs::path beside = jobs.string() + ending;
    if (!fs::exists(beside, error)) continue;
    return absl::FailedPreconditionError(absl::StrCat(
        beside.string(), " is left of a database of jobs that was there before, and ",
        "SQLite would add it to the restored one: move it away"));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<BackupCounts> back_up_store(const fs::path& store,
                                           const fs::path& jobs,
                                           const fs::path& backup) {
  const auto identity = read_store_identity(store);
  if (!identity.ok()) {
    return absl::NotFoundError(
        absl::StrCat(store.string(), " is no store: it has no ", kStoreIdentityFile));
  }
  if (auto taken = take_backup_folder(backup, *identity); !taken.ok()) return taken;
  // Files before the database, for what goes meanwhile; and after it, for what came.
  BackupCounts counts;
  std::set<fs::path> there;
  if (auto taken = take_files(store, backup, there, counts); !taken.ok()) return taken;
  std::error_code ignored;
  counts.has_jobs = !jobs.empty() && fs::exists(jobs, ignored);
  for (int look = 0; look < kMostLooks; ++look) {
    if (counts.has_jobs) {
      if (auto copied = back_up_sqlite(jobs, backup / kJobs); !copied.ok()) return copied;
    }
    there.clear();
    if (auto taken = take_files(store, backup, there, counts); !taken.ok()) return taken;
    if (!counts.has_jobs) break;
    const auto all = has_inputs(backup, there);
    if (!all.ok()) return all.status();
    if (*all) break;
  }
  if (auto dropped = drop_gone(backup, there, counts); !dropped.ok()) return dropped;
  if (auto done = finish(backup, *identity, counts.has_jobs); !done.ok()) return done;
  return counts;
}

absl::StatusOr<BackupCounts> restore_store(const fs::path& backup,
                                           const fs::path& store,
                                           const fs::path& jobs) {
  std::error_code ignored;
  const auto identity = read_store_identity(backup);
  if (!identity.ok() || !fs::exists(backup / kDone, ignored)) {
    return absl::FailedPreconditionError(
        absl::StrCat(backup.string(), " is no backup that was finished: it has no ", kDone));
  }
  if (auto empty = check_empty(store, jobs); !empty.ok()) return empty;
  const auto lock = StoreLock::take(store);
  if (!lock.ok()) return lock.status();
  BackupCounts counts;
  std::set<fs::path> there;
  if (auto taken = take_files(backup, store, there, counts); !taken.ok()) return taken;
  counts.files = there.size();
  counts.has_jobs = !jobs.empty() && fs::exists(backup / kJobs, ignored);
  if (counts.has_jobs) {
    if (auto copied = copy_whole_file(backup / kJobs, jobs); !copied.ok()) return copied;
    // It may be on another disk than the store.
    if (auto synced = sync_all(folder_of(jobs)); !synced.ok()) return synced;
  }
  // Last: without it no server takes the folder for this store.
  if (auto synced = sync_all(store); !synced.ok()) return synced;
  auto named = write_text_file((store / kStoreIdentityFile).string(), *identity + "\n");
  if (!named.ok()) return named;
  return counts;
}

}  // namespace tet
