// A grid file on this machine, as an upload needs it.
#pragma once

#include <cstdint>
#include <string>

#include <absl/status/statusor.h>

#include "core/base/cancel.h"

namespace tet {

struct LocalFile {
  std::string path;
  std::string name;  ///< `grids/{sha256}`
  std::uint64_t size_bytes = 0;
};

/// Reads all of a file to name it. Errors: kNotFound, kInvalidArgument (empty),
/// kCancelled, those of io_error (a disk that fails half-way must not look like the file's
/// end).
absl::StatusOr<LocalFile> name_file(const std::string& path, const Cancellation& cancellation);

}  // namespace tet
