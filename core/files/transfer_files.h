// Arrays of one mesh file on the mesh of another.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/base/parallel.h"
#include "core/remap/transfer.h"

namespace tet {

struct TransferFiles {
  std::string from, to, output;  ///< all .vtu
};

struct TransferReport {
  std::size_t points = 0, tets = 0;  ///< of the new mesh
  std::vector<TransferredArray> arrays;
  std::uint64_t outside_points = 0, outside_cells = 0;  ///< see TransferResult
  double farthest = 0;
  /// Arrays of the new mesh as a whole that its file does not have as text, and the output does
  /// not have.
  std::vector<std::string> left_out;
};

/// Writes `to` with the arrays of `from` beside its own; of one name those of `from` stay.
/// Errors: kInvalidArgument (another ending; see transfer), those of read_vtu and
/// write_data_vtu.
absl::StatusOr<TransferReport> transfer_files(TaskPool& pool,
                                              const TransferFiles& files,
                                              const TransferOptions& options,
                                              const Cancellation& cancellation = {});

}  // namespace tet
