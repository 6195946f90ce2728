// A decoder's work: one order, one result.
#pragma once

#include <absl/status/status.h>

#include "core/vdb/decoder/decoder_protocol.h"

namespace tet {

/// Does what the threading library does once in a process, which it may not do in the sandbox,
/// and sees to it that memory that a broken file leaves unset holds zeros, never what lay there
/// before.
void prepare_to_carry_out();

/// Loads OpenVDB, once, and does what it may not do in the sandbox, where nothing can be loaded
/// any more. Its threads sleep then. Errors: kUnavailable; kInternal (they do not).
absl::Status prepare_openvdb();

/// Reads what is ordered of `file` and leaves it in `result`, flat and sealed.
/// Errors: those of load_volume, load_field and list_grids; kResourceExhausted (over `limits`);
/// kFailedPrecondition (it needs OpenVDB, which was not prepared).
absl::Status carry_out(const DecodeOrder& order, int file, int result);

}  // namespace tet
