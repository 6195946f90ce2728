// Where exceptions of calls end: they cost the call, never the process.
#pragma once

#include <type_traits>

#include <absl/status/status.h>

#include "core/base/contain.h"

namespace tet {

/// For a catch block: logs what was thrown at `where`, for which the caller gets kInternal
/// (INTERNAL), without words that may be the server's own affair.
absl::Status thrown(const char* where) noexcept;

/// Runs `body`, which returns a status, a StatusOr or nothing, and tells how that went. What it
/// throws is `thrown`: nobody foresaw it, and whoever waits for an answer must get one.
template <class Body>
auto guarded(const char* where, const Body& body) {
  using Result = std::invoke_result_t<const Body&>;
  if constexpr (std::is_void_v<Result>) {
    try {
      body();
      return absl::OkStatus();
    } catch (...) {
      return thrown(where);
    }
  } else {
    try {
      return body();
    } catch (...) {
      return Result(thrown(where));
    }
  }
}

/// Has `contain` tell our log; for the beginning of a server.
void log_contained_exceptions();

}  // namespace tet
