// Arrays of one mesh file on the mesh of another.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tetstream/export.h"
#include "tetstream/request.h"
#include "tetstream/status.h"

namespace tetstream {

enum class TransferMode : std::uint8_t {
  kLinear,        ///< what is linear stays so; a cell gets the value of that around its middle
  kConservative,  ///< integrals stay
};

struct TransferOptions {
  TransferMode mode = TransferMode::kLinear;
  bool clamp = false;                    ///< no value lies beyond the old ones
  std::vector<std::string> arrays = {};  ///< by name; empty takes all
};

struct TransferredArray {
  std::string name;
  bool at_points = true;  ///< or else at cells
  /// Integrals of the first component, over each mesh.
  double old_integral = 0, new_integral = 0;
};

/// Writes the mesh of `to` with the arrays of `from` beside its own: all are .vtu files of tets
/// as write_mesh_file writes them, and the output is whole or not there. docs/transfer.md says
/// what a value is. Errors: kInvalidArgument (files that are something else, an array that is
/// not there), kNotFound, kUnavailable and kResourceExhausted (the disk), kCancelled,
/// kDeadlineExceeded.
TETSTREAM_API Result<std::vector<TransferredArray>> transfer_arrays(
    const std::string& from,
    const std::string& to,
    const std::string& output,
    const TransferOptions& options = {},
    const WorkOptions& work = {});

}  // namespace tetstream
