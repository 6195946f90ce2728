#include "server/http/exchange.h"

#include <utility>

#include <absl/strings/ascii.h>
#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/string_view.h>

#include "server/http/call_exchanges.h"
#include "server/http/json_routes.h"

namespace tet {

namespace {

using Made = std::variant<std::shared_ptr<Exchange>, HttpRefusal>;

/// An answer that is there.
class ReadyAnswer final : public Exchange {
 public:
  ReadyAnswer(AnswerStream& stream, HttpAnswer answer)
      : stream_(stream), answer_(std::move(answer)) {}
  void start(std::string /*body*/) override { stream_.send(std::move(answer_)); }
  void abandon() override {}

 private:
  AnswerStream& stream_;
  HttpAnswer answer_;
};

bool is_one_of(const std::string& word, std::initializer_list<absl::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// The type without its parameters.
std::string media_type(const RequestHead& head) {
  const absl::string_view type = head.value("content-type");
  return std::string(absl::StripAsciiWhitespace(type.substr(0, type.find(';'))));
}

HttpAnswer file_answer(const RequestHead& head, const PageFile& file) {
  HttpAnswer answer{200, file.type, {}, {}};
  answer.headers.emplace_back("Cache-Control", file.is_named_by_content
                                                   ? "public, max-age=31536000, immutable"
                                                   : "no-cache");
  answer.headers.emplace_back("Vary", "Accept-Encoding");
  const bool small =
      file.gzipped.size() > 0 && absl::StrContains(head.value("accept-encoding"), "gzip");
  if (small) answer.headers.emplace_back("Content-Encoding", "gzip");
  answer.kept = small ? file.gzipped : file.bytes;
  return answer;
}

/// Returns the pages that are no calls; a status of 0 where the path is none of theirs.
HttpAnswer plain_page(const HttpPlace& place, const RequestHead& head) {
  if (head.path == "/healthz") return {200, "text/plain", "ok\n"};
  if (head.path == "/readyz") {
    const bool ready = place.ready();
    return {ready ? 200 : 503, "text/plain", ready ? "ok\n" : "not ready\n"};
  }
  if (head.path == "/v1/openapi.json") return {200, "application/json", {}, {}, place.open_api};
  if (head.path == "/v1/grpc.json") return {200, "application/json", {}, {}, place.grpc_place};
  if (const PageFile* file = place.page.find(head.path)) return file_answer(head, *file);
  if (head.path == "/" && place.page.empty()) {
    return {404, "text/plain", "This server was built without its page: docs/browser.md\n"};
  }
  return {0, {}, {}};
}

Made make_grpc_web(const HttpPlace& place, const RequestHead& head, AnswerStream& stream) {
  if (head.method != "POST") return HttpRefusal{405, "calls are POSTed"};
  const auto* method = find_method(absl::string_view(head.path).substr(1));
  if (method == nullptr) return HttpRefusal{404, "there is no such method"};
  if (!is_one_of(media_type(head), {"application/grpc-web+proto", "application/grpc-web"})) {
    return HttpRefusal{415, "the Content-Type must be application/grpc-web+proto"};
  }
  if (method->client_streaming()) {
    return HttpRefusal{501, absl::StrCat(method->name(),
                                         " takes a stream, which a browser "
                                         "cannot send: use gRPC")};
  }
  return grpc_web_exchange(place, head, stream);
}

Made make_json(const HttpPlace& place, const RequestHead& head, AnswerStream& stream) {
  if (head.method == "PUT") return upload_exchange(place, head, stream);
  // A form of another page could send any other type without asking first.
  if (head.method == "POST" && media_type(head) != "application/json") {
    return HttpRefusal{415, "the Content-Type must be application/json"};
  }
  return json_exchange(place, head, stream);
}

}  // namespace

Made make_exchange(const HttpPlace& place, const RequestHead& head, AnswerStream& stream) {
  if (head.method == "OPTIONS") {
    if (place.gate.headers_for(head).empty()) {
      return HttpRefusal{403, "other origins may not ask unless http_origins names them"};
    }
    return std::make_shared<ReadyAnswer>(stream, HttpAnswer{200, "text/plain", ""});
  }
  if (head.method == "GET" || head.method == "HEAD") {
    if (is_one_of(head.path, {"/metrics", "/metrics/history"})) {
      return metrics_exchange(place, head, stream);
    }
    HttpAnswer page = plain_page(place, head);
    if (page.status != 0) return std::make_shared<ReadyAnswer>(stream, std::move(page));
    if (!is_json_path(head.path)) return HttpRefusal{404, "there is nothing at this path"};
  }
  if (!is_one_of(head.method, {"GET", "POST", "PUT", "DELETE"})) {
    return HttpRefusal{405, "GET, POST, PUT and DELETE are understood"};
  }
  return is_json_path(head.path) ? make_json(place, head, stream)
                                 : make_grpc_web(place, head, stream);
}

}  // namespace tet
