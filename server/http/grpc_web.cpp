#include "server/http/grpc_web.h"

#include <algorithm>

#include <absl/strings/ascii.h>
#include <absl/strings/escaping.h>
#include <absl/strings/match.h>
#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/string_view.h>

#include "proto/convert/status.h"

namespace tet {

namespace {

constexpr std::size_t kPrefixBytes = 5;
constexpr unsigned char kCompressed = 0x01;
constexpr char kTrailersFlag = '\x80';

std::string prefix_of(char flag, std::size_t bytes) {
  std::string prefix(1, flag);
  for (int shift = 24; shift >= 0; shift -= 8) {
    prefix.push_back(static_cast<char>(bytes >> shift & 0xff));
  }
  return prefix;
}

absl::Status malformed(const std::string& message) {
  return with_reason(absl::InvalidArgumentError(message), "MALFORMED");
}

}  // namespace

absl::StatusOr<absl::string_view> message_in(absl::string_view body) {
  if (body.size() < kPrefixBytes) {
    return malformed(
        absl::StrCat("the body has ", body.size(), " bytes: no frame of gRPC-Web"));
  }
  const auto flag = static_cast<unsigned char>(body[0]);
  if (flag == kCompressed) {
    return absl::UnimplementedError("compressed messages are not taken");
  }
  if (flag != 0) return malformed(absl::StrCat("a frame with flags ", flag));
  std::uint32_t length = 0;
  for (std::size_t i = 1; i < kPrefixBytes; ++i) {
    length = length << 8 | static_cast<unsigned char>(body[i]);
  }
  body.remove_prefix(kPrefixBytes);
  if (body.size() != length) {
    return malformed(absl::StrCat("the frame says ", length, " bytes, and there are ",
                                  body.size(), "; one message is a call"));
  }
  return body;
}

std::string frame_prefix(std::size_t message_bytes) { return prefix_of('\0', message_bytes); }

std::string trailers_frame(const grpc::Status& status, const Trailers& trailers) {
  std::string text =
      absl::StrCat("grpc-status: ", static_cast<int>(status.error_code()), "\r\n");
  if (!status.error_message().empty()) {
    absl::StrAppend(&text, "grpc-message: ", encode_message(status.error_message()), "\r\n");
  }
  for (const auto& [name, value] : trailers) {
    const bool binary = absl::EndsWith(name, "-bin");
    absl::StrAppend(&text, name, ": ", binary ? absl::Base64Escape(value) : value, "\r\n");
  }
  return prefix_of(kTrailersFlag, text.size()) + text;
}

std::string encode_message(absl::string_view message) {
  std::string encoded;
  for (const char c : message) {
    if (c >= ' ' && c <= '~' && c != '%') {
      encoded.push_back(c);
    } else {
      absl::StrAppendFormat(&encoded, "%%%02X", static_cast<unsigned char>(c));
    }
  }
  return encoded;
}

std::optional<std::chrono::nanoseconds> parse_timeout(absl::string_view text) {
  std::int64_t number = 0;
  if (text.size() < 2 || text.size() > 9) return std::nullopt;
  const absl::string_view digits = text.substr(0, text.size() - 1);
  const bool all_digits = std::all_of(digits.begin(), digits.end(),
                                      [](unsigned char c) { return absl::ascii_isdigit(c); });
  if (!all_digits || !absl::SimpleAtoi(digits, &number)) return std::nullopt;
  // Beyond a hundred thousand hours nanoseconds would no longer fit.
  constexpr std::int64_t kMostHours = 100'000;
  switch (text.back()) {
    case 'H':
      return std::chrono::hours(std::min(number, kMostHours));
    case 'M':
      return std::chrono::minutes(std::min(number, kMostHours * 60));
    case 'S':
      return std::chrono::seconds(number);
    case 'm':
      return std::chrono::milliseconds(number);
    case 'u':
      return std::chrono::microseconds(number);
    case 'n':
      return std::chrono::nanoseconds(number);
    default:
      return std::nullopt;
  }
}

}  // namespace tet
