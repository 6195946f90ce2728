// A decoder's work: one order, one result.
#pragma once

#include <absl/status/status.h>

#include "core/decode/decoder_protocol.h"

namespace tet {

/// Reads what is ordered of `file` with OpenVDB and leaves it in `result`, flat and sealed.
/// Errors: those of load_volume and list_grids; kResourceExhausted (over `limits`).
absl::Status carry_out(const DecodeOrder& order, int file, int result);

}  // namespace tet
