// Whether a store is what it should be.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include <absl/status/statusor.h>

namespace tet {

struct CheckCounts {
  std::uint64_t files = 0, bytes = 0;  ///< that were read
  std::uint64_t problems = 0;          ///< that were told
};

/// Reads every file of a store and compares it with its name or its checksum, and has SQLite
/// look at the database; `tell` gets a line for each problem. Changes nothing, and may be run
/// beside a server: a file that goes meanwhile is none. `jobs` is SQLite's file, or empty.
/// Errors: kNotFound (no store), the disk's.
absl::StatusOr<CheckCounts> check_store(const std::filesystem::path& store,
                                        const std::filesystem::path& jobs,
                                        const std::function<void(const std::string&)>& tell);

}  // namespace tet
