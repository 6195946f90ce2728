#include "server/http/http_gate.h"

#include <algorithm>

#include <absl/strings/ascii.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_split.h>
#include <absl/strings/string_view.h>

#include "proto/wire/loopback.h"

namespace tet {

namespace {

/// Returns what follows "://"; all of it where nothing does.
absl::string_view authority_of(absl::string_view origin) {
  const std::size_t at = origin.find("://");
  return at == absl::string_view::npos ? origin : origin.substr(at + 3);
}

/// is_loopback wants a port.
bool is_this_machine(absl::string_view host) {
  const bool port = host.rfind(':') != absl::string_view::npos && host.back() != ']';
  return is_loopback(port ? std::string(host) : absl::StrCat(host, ":80"));
}

}  // namespace

HttpGate::HttpGate(bool loopback, absl::string_view origins) : loopback_(loopback) {
  for (const absl::string_view origin : absl::StrSplit(origins, ',', absl::SkipWhitespace())) {
    origins_.push_back(absl::AsciiStrToLower(absl::StripAsciiWhitespace(origin)));
  }
}

bool HttpGate::is_allowed(absl::string_view origin) const {
  return std::find(origins_.begin(), origins_.end(), absl::AsciiStrToLower(origin)) !=
         origins_.end();
}

std::optional<HttpRefusal> HttpGate::check(const RequestHead& head) const {
  const std::string host = absl::AsciiStrToLower(head.value("host"));
  const bool listed = std::any_of(origins_.begin(), origins_.end(), [&](const auto& origin) {
    return authority_of(origin) == host;
  });
  if (loopback_ && !listed && !is_this_machine(host)) {
    return HttpRefusal{421,
                       "this port serves its own machine alone: ask for localhost, or name "
                       "the origin in http_origins"};
  }
  const std::string* origin = head.find("origin");
  if (origin == nullptr || is_allowed(*origin)) return std::nullopt;
  if (authority_of(absl::AsciiStrToLower(*origin)) == host) return std::nullopt;
  return HttpRefusal{403,
                     "pages of other origins may not ask unless http_origins names theirs"};
}

HttpHeaders HttpGate::headers_for(const RequestHead& head) const {
  const std::string* origin = head.find("origin");
  if (origin == nullptr || !is_allowed(*origin)) return {};
  HttpHeaders headers{{"Access-Control-Allow-Origin", *origin},
                      {"Vary", "Origin"},
                      {"Access-Control-Expose-Headers", "x-request-id, content-range"}};
  if (head.method == "OPTIONS") {
    headers.emplace_back("Access-Control-Allow-Methods", "GET, POST, PUT, DELETE");
    headers.emplace_back(
        "Access-Control-Allow-Headers",
        "authorization, content-type, content-range, grpc-timeout, x-grpc-web, "
        "x-user-agent, x-request-id, traceparent");
    headers.emplace_back("Access-Control-Max-Age", "600");
  }
  return headers;
}

}  // namespace tet
