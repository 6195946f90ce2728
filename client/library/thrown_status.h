// What libraries throw, as the status that the rest of the client tells of.
#pragma once

#include <absl/status/status.h>

namespace tet {

/// For a catch block, as of a thread's outermost function: kResourceExhausted where memory was
/// short, kInternal for anything else, with the exception's own words.
absl::Status status_of_exception();

}  // namespace tet
