// What a decoder gives up before it reads a byte that others wrote.
#pragma once

#include <absl/status/status.h>

#include "core/vdb/decoder/decoder_protocol.h"

namespace tet {

/// Ends with the parent, leaves no core dump, cannot be looked into, gains no rights, and is
/// the first to be ended where memory is short. For the beginning of the program.
absl::Status enter_custody();

/// From here on the process has the memory and the time of `limits`, no more files or
/// processes, and only the system calls that reading `file`, writing `result`, answering on
/// `socket`, allocating and exiting take; any other one kills it. That holds for every thread
/// it has, those that libraries have started too.
///
/// Builds with a sanitizer keep only the limit on time: their shadow memory is larger than any
/// limit, and they make system calls of their own.
absl::Status enter_sandbox(const DecodeLimits& limits, int socket, int file, int result);

}  // namespace tet
