// Where the decoder's program is, and modules beside it.
#pragma once

#include <string>

#include <absl/status/statusor.h>

namespace tet {

/// `given` if it is not empty; else tetstream-decoder beside the running program, in
/// ../libexec/tetstream from there, or in libexec/tetstream beside a folder that the shared
/// library with this code lies in (as in PREFIX/lib, and PREFIX/lib/x86_64-linux-gnu). Errors:
/// kUnavailable (none is there; says where it was looked for).
absl::StatusOr<std::string> find_decoder(const std::string& given);

/// The module of that file name, in the same folders. Errors: kNotFound (says where it was
/// looked for).
absl::StatusOr<std::string> find_module(const char* name);

}  // namespace tet
