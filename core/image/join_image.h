// Images of two files and more, joined into one: a header (.nhdr, .mhd) and its data.
#pragma once

#include <string>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/base/cancel.h"

namespace tet {

/// Whether the file is a header whose data are in others. False of what cannot be read.
bool is_detached_image(const std::string& path);

/// The files that such a header names for its data. None of any other file, nor of one whose
/// header is wrong, which whoever reads it tells of.
std::vector<std::string> data_files_of(const std::string& header);

/// Writes the header and its data to `joined`, which is made.
///
/// A header may name files beside it or below alone, and no links: it may be somebody else's,
/// and what it names goes to where its mesh goes. Errors: those of the header's reader,
/// kNotFound (a file that it names), kPermissionDenied, kInvalidArgument (a file that is too
/// short, or elsewhere; says what to do), kCancelled.
absl::Status join_image(const std::string& header,
                        const std::string& joined,
                        const Cancellation& cancellation);

}  // namespace tet
