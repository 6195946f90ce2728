// A strict look at a file that may hold an image, before anything is built of it.
#pragma once

#include <absl/status/statusor.h>

#include "core/base/posix/byte_source.h"
#include "core/image/image_outline.h"

namespace tet {

/// Whether a file is one of an image, by its first bytes: names say nothing here.
bool is_image(const ByteSource& source);

/// Reads the header. At most a megabyte of the file is looked at, whatever it claims, and
/// nothing is unpacked. Errors: kInvalidArgument (it breaks its format), kFailedPrecondition
/// (it holds what is not read: says what to do).
absl::StatusOr<ImageOutline> outline_image(const ByteSource& source);

}  // namespace tet
