// What only HDF5 can do, as a part of tetstream that is loaded when something needs it.
//
// HDF5 brings forty libraries along, which take 7 ms of a processor to load.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "core/files/hdf5_outline.h"

namespace tet {

struct Hdf5Part {
  /// Makes a file of this outline at `path`, and appends where each column lies, or
  /// Hdf5Places::kNowhere. False when that fails.
  bool (*lay_out)(const std::string& path,
                  const Hdf5Outline& outline,
                  std::vector<std::uint64_t>& places);
};

/// Loads the part, the first time. Thread-safe. Errors: kUnavailable (it is not installed; says
/// where it was looked for).
absl::StatusOr<const Hdf5Part*> hdf5_part();

}  // namespace tet
