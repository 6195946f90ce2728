// A decoder's work: one order, one result.
#pragma once

#include <absl/status/status.h>

#include "core/vdb/decoder_protocol.h"

namespace tet {

/// Does what OpenVDB and the threading library do once in a process, which they may not do in
/// the sandbox, and sees to it that memory that a broken file leaves unset holds zeros, never
/// what lay there before.
void prepare_to_carry_out();

/// Reads what is ordered of `file` with OpenVDB and leaves it in `result`, flat and sealed.
/// Errors: those of load_volume, load_field and list_grids; kResourceExhausted (over `limits`).
absl::Status carry_out(const DecodeOrder& order, int file, int result);

}  // namespace tet
