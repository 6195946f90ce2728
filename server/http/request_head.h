// The head of an HTTP/1.1 request, from bytes that anyone may have sent.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <absl/strings/string_view.h>

namespace tet {

/// Why a request is not answered: a status of HTTP, and words for whoever sent it.
struct HttpRefusal {
  int status = 400;
  std::string message;
};

struct RequestHead {
  std::string method;
  std::string path;   ///< of the target, as it came: begins with "/", nothing is decoded
  std::string query;  ///< of the target, without the "?"
  std::vector<std::pair<std::string, std::string>> fields;  ///< names in lower case
  std::optional<std::uint64_t> content_length;
  bool keep_alive = true;
  bool expects_continue = false;

  /// Returns a field's value; null where there is none.
  const std::string* find(absl::string_view name) const noexcept;
  /// Returns a field's value; empty where there is none.
  absl::string_view value(absl::string_view name) const noexcept;
};

struct HeadLimits {
  std::size_t bytes = 16 << 10;
  std::size_t fields = 64;
  std::size_t target_bytes = 4096;
};

/// Returns the bytes of the head that `received` begins with, its empty line included; none
/// while that has not come.
std::optional<std::size_t> head_size(absl::string_view received) noexcept;

/// Reads a whole head. It is strict, so that nobody before us can have read it in another way:
/// lines end in CR LF, nothing is folded, names are followed by their colon at once, every byte
/// is printable ASCII, fields that matter come once, and bodies have their length told by one
/// Content-Length and never by a Transfer-Encoding.
std::variant<RequestHead, HttpRefusal> parse_head(absl::string_view head,
                                                  const HeadLimits& limits);

/// Decodes %XX and, in queries, "+". None where it is malformed, or hides a control character.
std::optional<std::string> decode_query(absl::string_view text);

}  // namespace tet
