// Backups of a store, and stores made of them.
#pragma once

#include <cstdint>
#include <filesystem>

#include <absl/status/statusor.h>

namespace tet {

struct BackupCounts {
  std::uint64_t files = 0;       ///< in the backup, or in the store made of it
  std::uint64_t new_files = 0;   ///< that were not there before
  std::uint64_t gone_files = 0;  ///< that were removed, since the store has them no more
  bool has_jobs = false;         ///< SQLite's file of jobs is among them
};

/// Makes `backup` a backup of `store`, or brings it up to date, whatever works on the store
/// meanwhile: files by hard links where the file system can, SQLite's jobs as they are at one
/// moment. What was acknowledged before this began is in it, with all that its jobs read. Where
/// it fails the older state of `backup` is kept, but for files that were added.
///
/// `jobs` is the database's file; empty where the jobs are elsewhere or off. Errors: kNotFound
/// (no store), kFailedPrecondition (`backup` is that of another store, or no backup), the
/// disk's, the database's.
absl::StatusOr<BackupCounts> back_up_store(const std::filesystem::path& store,
                                           const std::filesystem::path& jobs,
                                           const std::filesystem::path& backup);

/// Makes a store of a backup: in `store`, which must be empty or not there. `jobs` is where the
/// database's file goes; empty leaves it out. Errors: kFailedPrecondition (something is in
/// `store` or at `jobs`, or of a database that was there, or `backup` is none that was
/// finished), the disk's.
absl::StatusOr<BackupCounts> restore_store(const std::filesystem::path& backup,
                                           const std::filesystem::path& store,
                                           const std::filesystem::path& jobs);

}  // namespace tet
