// Arrays of one mesh on another one.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/remap/data_mesh.h"

namespace tet {

enum class TransferMode : std::uint8_t {
  /// A point gets what the tet around it says there, a cell the value of the cell around its
  /// middle. What is linear stays so.
  kLinear,
  /// Integrals stay: values at points are the nearest in the sense of least squares to the old
  /// ones, a cell's is the mean of what it covers.
  kConservative,
};

struct TransferOptions {
  TransferMode mode = TransferMode::kLinear;
  /// No value lies beyond the old ones: of the tet that it comes from, or with kConservative of
  /// the array.
  bool clamp = false;
  std::vector<std::string> arrays = {};  ///< by name; empty takes all
};

/// An array's integral over both meshes, of its first component.
struct TransferredArray {
  std::string name;
  bool at_points = true;
  double old_integral = 0, new_integral = 0;
};

struct TransferResult {
  std::vector<DataArray> point_data, cell_data;  ///< of the new mesh
  std::vector<TransferredArray> told;
  /// New points and middles of new cells that lie outside the old mesh, and how far at most.
  std::uint64_t outside_points = 0, outside_cells = 0;
  double farthest = 0;
};

/// A point outside the old mesh gets what the nearest tet says there as far as the longest edge
/// of that tet, and beyond what it says at the nearest corner. Parallel; run it on a TaskPool;
/// one result for any number of threads. Errors: kInvalidArgument (no tets, no such array, and
/// with kConservative meshes that have nothing in common), kCancelled, kDeadlineExceeded.
absl::StatusOr<TransferResult> transfer(const DataMesh& from,
                                        const DataMesh& to,
                                        const TransferOptions& options,
                                        const Cancellation& cancellation = {});

}  // namespace tet
