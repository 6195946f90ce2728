// What reaches the HTTP port, as bytes: a head that is read in one way or refused, a frame of
// gRPC-Web that is one message or refused, JSON that is a message or refused.
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

#include "server/http/grpc_web.h"
#include "server/http/http_gate.h"
#include "server/http/json_routes.h"
#include "server/http/request_head.h"
#include "tests/fuzz/fuzz_target.h"

namespace tet::http_request_fuzz {
namespace {

bool is_clean(const std::string& text) {
  for (const char c : text) {
    if (c < ' ' || c > '~') return false;
  }
  return true;
}

/// A head that was taken says where its body ends, and hides no second one.
void check_head(const RequestHead& head) {
  require(head.find("transfer-encoding") == nullptr);
  require(head.content_length.has_value() == (head.find("content-length") != nullptr));
  require(!head.path.empty() && head.path.front() == '/');
  require(is_clean(head.method + head.path + head.query));
  int hosts = 0;
  for (const auto& [name, value] : head.fields) {
    require(is_clean(name) && is_clean(value) && name.find(':') == std::string::npos);
    hosts += name == "host" ? 1 : 0;
  }
  require(hosts == 1);
  static_cast<void>(HttpGate(true, "https://a.example").check(head));
  static_cast<void>(decode_query(head.query));
}

void check_frame(const std::string& body) {
  const auto message = message_in(body);
  if (!message.ok()) return;
  require(frame_prefix(message->size()) + std::string(*message) == body);
}

}  // namespace

TET_FUZZ_TARGET(http_request_fuzz) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  check_frame(bytes);
  static_cast<void>(parse_timeout(bytes));
  const auto end = head_size(bytes);
  if (!end) return 0;
  const auto parsed = parse_head(bytes.substr(0, *end), HeadLimits{});
  if (const auto* refusal = std::get_if<HttpRefusal>(&parsed)) {
    require(refusal->status >= 400 && refusal->status < 600);
    return 0;
  }
  const auto& head = std::get<RequestHead>(parsed);
  check_head(head);
  const auto call = read_json_call(head, bytes.substr(*end));
  require(std::holds_alternative<HttpRefusal>(call) ||
          std::get<JsonCall>(call).method != nullptr);
  return 0;
}

}  // namespace tet::http_request_fuzz
