// Whether work can be done here at all: the right store of files is there, and takes results.
#pragma once

#include <filesystem>
#include <mutex>
#include <string>

#include <absl/status/status.h>

#include "server/jobs/results/result_store.h"
#include "server/jobs/store/job_store.h"

namespace tet {

/// Whose store of files it is.
enum class StoreUse {
  kOwn,     ///< this process has it locked: it gives it an identity, and the jobs belong to it
  kBeside,  ///< a server's, perhaps on another host: it is only compared
};

/// The folder of the store against the store that the jobs belong to. A folder where nothing is
/// mounted looks like an empty store: whoever worked in it would fail every job that reads a
/// grid, and lose the results of all others.
///
/// Thread safety: every member may be called from any thread. What it refers to outlives it.
class WorkPlace {
 public:
  WorkPlace(JobStore& jobs, std::filesystem::path store, StoreUse use)
      : jobs_(jobs), store_(std::move(store)), use_(use) {}

  /// Reads one small file, and asks the job store until it has answered once. Errors:
  /// kFailedPrecondition (WRONG_STORE: the folder is not the store that the jobs belong to),
  /// the job store's, the disk's.
  absl::Status check_store();

  /// `check_store`, and whether the disk takes results. Errors: also those of
  /// ResultStore::probe.
  absl::Status check(const ResultStore& results);

 private:
  absl::Status learn_whose_jobs(const std::string& found);

  JobStore& jobs_;
  const std::filesystem::path store_;
  const StoreUse use_;
  std::mutex mutex_;
  std::string wanted_;  ///< the store that the jobs belong to; empty while that is not known
};

}  // namespace tet
