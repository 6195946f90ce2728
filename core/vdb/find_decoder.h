// Where the decoder's program is.
#pragma once

#include <string>

#include <absl/status/statusor.h>

namespace tet {

/// `given` if it is not empty; else tetstream-decoder beside the running program, or in
/// ../libexec/tetstream from there. Errors: kUnavailable (none is there; says where it was
/// looked for).
absl::StatusOr<std::string> find_decoder(const std::string& given);

}  // namespace tet
