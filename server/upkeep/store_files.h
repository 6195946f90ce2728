// What of a store is worth keeping: its files, by what may be done with them.
#pragma once

#include <filesystem>
#include <functional>

#include <absl/status/status.h>

namespace tet {

/// How a file of a store may change.
enum class FileKind {
  kNever,  ///< it only comes and goes, and a hard link is as good as a copy
  kGrows,  ///< an upload under way
};

struct StoreFile {
  std::filesystem::path path;  ///< relative to the store
  FileKind kind = FileKind::kNever;
};

/// Calls `visit` for the files of a store: its identity, grids, uploads under way, results and
/// plans; not for the jobs' database, locks, damaged files, nor what is not whole. Files may
/// come and go meanwhile. Errors: those of `visit`, which ends it.
absl::Status for_each_store_file(const std::filesystem::path& store,
                                 const std::function<absl::Status(const StoreFile&)>& visit);

/// Where a grid is in a store.
std::filesystem::path grid_file(const std::string& space, const std::string& digest);

/// Copies a file, durably; it appears whole, with the time of the other. Errors: kNotFound (it
/// is gone), the disk's.
absl::Status copy_whole_file(const std::filesystem::path& from,
                             const std::filesystem::path& to);

/// A hard link where the file system can, else a copy. Errors: those of `copy_whole_file`.
absl::Status link_or_copy(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace tet
