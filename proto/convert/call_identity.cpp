#include "proto/convert/call_identity.h"

#include <algorithm>
#include <cstdint>
#include <random>

#include <absl/strings/ascii.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/base/printable.h"

namespace tet {

namespace {

constexpr char kRequestIdKey[] = "x-request-id";
constexpr char kTraceKey[] = "traceparent";
constexpr std::size_t kMaxRequestId = 128;
constexpr std::size_t kMaxUserAgent = 120;

std::uint64_t random_number() {
  static thread_local std::mt19937_64 random{std::random_device{}()};
  return random();
}

std::string random_hex() { return absl::StrFormat("%016x", random_number()); }

std::string_view value_of(const grpc::CallbackServerContext& context, const char* key) {
  const auto found = context.client_metadata().find(key);
  if (found == context.client_metadata().end()) return {};
  return {found->second.data(), found->second.size()};
}

bool is_request_id(std::string_view text) {
  return !text.empty() && text.size() <= kMaxRequestId &&
         std::all_of(text.begin(), text.end(), [](unsigned char c) {
           return absl::ascii_isalnum(c) || std::string_view("-_.:/+=").find(
                                                static_cast<char>(c)) != std::string_view::npos;
         });
}

bool is_lower_hex(std::string_view text) {
  return text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

/// Hexadecimal digits that are not all zero, which would mean no id.
bool is_id(std::string_view text) {
  return is_lower_hex(text) && text.find_first_not_of('0') != std::string_view::npos;
}

}  // namespace

std::string TraceSpan::traceparent() const {
  return trace_id.empty() ? "" : absl::StrCat("00-", trace_id, "-", span_id, "-", flags);
}

// version "-" trace-id "-" parent-id "-" flags. A later version may go on after another "-".
TraceSpan span_below(std::string_view traceparent) {
  constexpr std::size_t kSize = 55;
  if (traceparent.size() < kSize) return {};
  const auto version = traceparent.substr(0, 2), trace = traceparent.substr(3, 32),
             parent = traceparent.substr(36, 16), flags = traceparent.substr(53, 2);
  const bool dashes = traceparent[2] == '-' && traceparent[35] == '-' && traceparent[52] == '-';
  const bool ends =
      traceparent.size() == kSize || (version != "00" && traceparent[kSize] == '-');
  if (!dashes || !ends || !is_lower_hex(version) || version == "ff") return {};
  if (!is_id(trace) || !is_id(parent) || !is_lower_hex(flags)) return {};
  return {std::string(trace), std::string(parent), random_hex(), std::string(flags)};
}

CallIdentity identify(const grpc::CallbackServerContext& context) {
  const std::string_view asked = value_of(context, kRequestIdKey);
  return {is_request_id(asked) ? std::string(asked) : random_hex(),
          span_below(value_of(context, kTraceKey)),
          printable(value_of(context, "user-agent"), kMaxUserAgent)};
}

void tell_identity(const CallIdentity& identity, grpc::CallbackServerContext& context) {
  context.AddTrailingMetadata(kRequestIdKey, identity.request_id);
  if (identity.span.trace_id.empty()) return;
  context.AddTrailingMetadata(kTraceKey, identity.span.traceparent());
}

}  // namespace tet
