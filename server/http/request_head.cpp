#include "server/http/request_head.h"

#include <algorithm>

#include <absl/strings/ascii.h>
#include <absl/strings/match.h>
#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_split.h>
#include <absl/strings/string_view.h>

namespace tet {

namespace {

constexpr absl::string_view kEndOfHead = "\r\n\r\n";
constexpr std::size_t kMostLengthDigits = 18;

// Two of these would be read in two ways.
constexpr absl::string_view kOnce[] = {
    "host",          "content-length",  "authorization", "content-type", "origin",
    "content-range", "grpc-timeout",    "expect",        "x-request-id", "traceparent",
    "range",         "accept-encoding", "if-none-match", "user-agent"};

bool is_token_char(unsigned char c) noexcept {
  return absl::ascii_isalnum(c) ||
         absl::string_view("!#$%&'*+-.^_`|~").find(static_cast<char>(c)) !=
             absl::string_view::npos;
}

bool is_token(absl::string_view text) noexcept {
  return !text.empty() && std::all_of(text.begin(), text.end(), is_token_char);
}

bool is_printable_value(absl::string_view text) noexcept {
  return std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return c >= 0x20 && c < 0x7f;  // gRPC's metadata takes no more
  });
}

bool is_visible(absl::string_view text) noexcept {
  return std::all_of(text.begin(), text.end(),
                     [](unsigned char c) { return c > 0x20 && c < 0x7f; });
}

std::optional<HttpRefusal> refuse(int status, std::string message) {
  return HttpRefusal{status, std::move(message)};
}

std::optional<HttpRefusal> read_request_line(absl::string_view line,
                                             const HeadLimits& limits,
                                             RequestHead& head) {
  const std::vector<absl::string_view> parts = absl::StrSplit(line, ' ');
  if (parts.size() != 3) return refuse(400, "the request line is not METHOD TARGET VERSION");
  if (parts[2] != "HTTP/1.1") return refuse(505, "only HTTP/1.1 is spoken here");
  if (!is_token(parts[0]) || parts[0].size() > 16) return refuse(400, "malformed method");
  if (parts[1].size() > limits.target_bytes) {
    return refuse(414, absl::StrCat("the target has ", parts[1].size(), " bytes, and ",
                                    limits.target_bytes, " are the most"));
  }
  if (!absl::StartsWith(parts[1], "/") || !is_visible(parts[1]) ||
      absl::StrContains(parts[1], "#")) {
    return refuse(400, "the target is not a path");
  }
  head.method = std::string(parts[0]);
  const std::pair<absl::string_view, absl::string_view> target =
      absl::StrSplit(parts[1], absl::MaxSplits('?', 1));
  head.path = std::string(target.first);
  head.query = std::string(target.second);
  return std::nullopt;
}

std::optional<HttpRefusal> read_field(absl::string_view line, RequestHead& head) {
  const std::size_t colon = line.find(':');
  if (colon == absl::string_view::npos || !is_token(line.substr(0, colon))) {
    return refuse(400, "a line of the head is not NAME: VALUE");
  }
  const absl::string_view value = absl::StripAsciiWhitespace(line.substr(colon + 1));
  if (!is_printable_value(value)) return refuse(400, "a header is not printable ASCII");
  std::string name = absl::AsciiStrToLower(line.substr(0, colon));
  const bool once = std::find(std::begin(kOnce), std::end(kOnce), name) != std::end(kOnce);
  if (once && head.find(name) != nullptr) {
    return refuse(400, absl::StrCat("there is more than one ", name));
  }
  head.fields.emplace_back(std::move(name), std::string(value));
  return std::nullopt;
}

std::optional<HttpRefusal> read_length(RequestHead& head) {
  if (head.find("transfer-encoding") != nullptr) {
    return refuse(501, "Transfer-Encoding is not taken: send a Content-Length");
  }
  const std::string* length = head.find("content-length");
  if (length == nullptr) return std::nullopt;
  std::uint64_t bytes = 0;
  const bool digits = !length->empty() && length->size() <= kMostLengthDigits &&
                      std::all_of(length->begin(), length->end(),
                                  [](unsigned char c) { return absl::ascii_isdigit(c); });
  if (!digits || !absl::SimpleAtoi(*length, &bytes)) {
    return refuse(400, "Content-Length is not a number of bytes");
  }
  head.content_length = bytes;
  return std::nullopt;
}

/// Reads what the connection is to do.
std::optional<HttpRefusal> read_manners(RequestHead& head) {
  if (head.value("host").empty()) return refuse(400, "there is no Host");
  for (const auto& [name, value] : head.fields) {
    if (name != "connection") continue;
    for (const absl::string_view word : absl::StrSplit(value, ',')) {
      if (absl::EqualsIgnoreCase(absl::StripAsciiWhitespace(word), "close")) {
        head.keep_alive = false;
      }
    }
  }
  const std::string* expect = head.find("expect");
  if (expect == nullptr) return std::nullopt;
  if (!absl::EqualsIgnoreCase(*expect, "100-continue")) {
    return refuse(417, "only 100-continue may be expected");
  }
  head.expects_continue = true;
  return std::nullopt;
}

std::optional<HttpRefusal> read_lines(absl::string_view text,
                                      const HeadLimits& limits,
                                      RequestHead& head) {
  bool first = true;
  while (!text.empty()) {
    const std::size_t end = text.find("\r\n");
    if (end == absl::string_view::npos) return refuse(400, "a line does not end");
    const absl::string_view line = text.substr(0, end);
    text.remove_prefix(end + 2);
    if (line.find_first_of(absl::string_view("\r\n\0", 3)) != absl::string_view::npos) {
      return refuse(400, "a line ends in something else than CR LF");
    }
    auto refused = std::exchange(first, false) ? read_request_line(line, limits, head)
                                               : read_field(line, head);
    if (refused) return refused;
    if (head.fields.size() > limits.fields) {
      return refuse(431, absl::StrCat("more than ", limits.fields, " headers"));
    }
  }
  return std::nullopt;
}

}  // namespace

const std::string* RequestHead::find(absl::string_view name) const noexcept {
  for (const auto& [field, value] : fields) {
    if (field == name) return &value;
  }
  return nullptr;
}

absl::string_view RequestHead::value(absl::string_view name) const noexcept {
  const std::string* found = find(name);
  return found == nullptr ? absl::string_view() : absl::string_view(*found);
}

std::optional<std::size_t> head_size(absl::string_view received) noexcept {
  const std::size_t end = received.find(kEndOfHead);
  if (end == absl::string_view::npos) return std::nullopt;
  return end + kEndOfHead.size();
}

std::variant<RequestHead, HttpRefusal> parse_head(absl::string_view head,
                                                  const HeadLimits& limits) {
  if (head.size() > limits.bytes) {
    return HttpRefusal{431, absl::StrCat("the head has more than ", limits.bytes, " bytes")};
  }
  if (!absl::EndsWith(head, kEndOfHead)) return HttpRefusal{400, "the head does not end"};
  head.remove_suffix(2);
  RequestHead read;
  auto refused = read_lines(head, limits, read);
  if (!refused) refused = read_length(read);
  if (!refused) refused = read_manners(read);
  if (refused) return *std::move(refused);
  return read;
}

std::optional<std::string> decode_query(absl::string_view text) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned int c = static_cast<unsigned char>(text[i]);
    if (c == '+') c = ' ';
    if (c == '%') {
      if (!absl::SimpleHexAtoi(text.substr(i + 1, 2), &c) || i + 2 >= text.size() ||
          !absl::ascii_isxdigit(static_cast<unsigned char>(text[i + 1])) ||
          !absl::ascii_isxdigit(static_cast<unsigned char>(text[i + 2]))) {
        return std::nullopt;
      }
      i += 2;
    }
    if (c < 0x20 || c == 0x7f) return std::nullopt;
    decoded.push_back(static_cast<char>(c));
  }
  return decoded;
}

}  // namespace tet
