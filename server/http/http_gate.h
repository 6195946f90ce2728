// Which pages of a browser may ask: ours, and those of other origins that a setting names.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <absl/strings/string_view.h>

#include "server/http/http_answer.h"
#include "server/http/request_head.h"

namespace tet {

/// Checks Host and Origin, as a page from elsewhere in somebody's browser reaches a port that
/// its maker does not. Immutable.
class HttpGate {
 public:
  /// `origins` is a list like "https://a.example, https://b.example:8443". On `loopback` only
  /// names of this machine are taken for hosts: another one that leads here is a trap.
  HttpGate(bool loopback, absl::string_view origins);

  std::optional<HttpRefusal> check(const RequestHead& head) const;
  /// Returns the headers that let the page of another origin read the answer; none for ours.
  HttpHeaders headers_for(const RequestHead& head) const;

 private:
  bool is_allowed(absl::string_view origin) const;

  const bool loopback_;
  std::vector<std::string> origins_;
};

}  // namespace tet
