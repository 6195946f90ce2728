// How many bytes of results all processes have stored together: an account in the store itself.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <utility>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/base/posix/file.h"

namespace tet {

/// Whoever adds to the results or evicts from them says so here first, so that the budget holds
/// for all processes, on one host or on many that share a file system. What a process that died
/// has asked for and not written stays in the account until somebody counts at a time when
/// nobody writes.
///
/// Thread-safe. Errors of all: the disk's, kUnavailable (somebody held the account for too
/// long).
class ResultLedger {
 public:
  explicit ResultLedger(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// The account, which nobody else has meanwhile: for a short time.
  class Turn {
   public:
    /// Returns nothing where nobody has counted, or the file is damaged.
    std::optional<std::uint64_t> total() const;
    absl::Status set(std::uint64_t total);

    /// Whether all that was asked for is written or given up; it stays so for this turn, or
    /// until it joins the writers.
    absl::StatusOr<bool> is_quiet();
    /// Somebody who writes what this turn adds, for as long as the file is open.
    absl::StatusOr<File> join_writers();

   private:
    friend class ResultLedger;
    Turn(std::filesystem::path folder, File file)
        : folder_(std::move(folder)), file_(std::move(file)) {}

    std::filesystem::path folder_;
    File file_;
    std::optional<File> nobody_writes_;
  };

  /// Errors: kNotFound (there are no results yet), and as above.
  absl::StatusOr<Turn> take() const;

 private:
  const std::filesystem::path folder_;
};

}  // namespace tet
