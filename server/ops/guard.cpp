#include "server/ops/guard.h"

#include <string>

#include <absl/strings/str_cat.h>

#include "proto/convert/status.h"
#include "server/ops/logging.h"

namespace tet {

namespace {

void log_exception(const char* where, const std::string& what) {
  log_event(spdlog::level::err, "exception", {{"where", where}, {"what", what}});
}

}  // namespace

absl::Status thrown(const char* where) noexcept {
  contain(where, [&] { log_exception(where, words_of_exception()); });
  try {
    return with_reason(absl::InternalError(absl::StrCat("the server failed in ", where,
                                                        ": report it with the request's id")),
                       "INTERNAL");
  } catch (...) {
    return absl::Status(absl::StatusCode::kInternal, "");
  }
}

void log_contained_exceptions() { tell_exceptions(log_exception); }

}  // namespace tet
