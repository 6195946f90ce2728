#include "server/http/http_answer.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/string_view.h>

#include "server/http/json_routes.h"

namespace tet {

namespace {

// What the page may do: run and style itself from here, speak to here, and nothing else.
constexpr absl::string_view kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
    "connect-src 'self'; worker-src 'self'; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'";

absl::string_view words_of_status(int status) {
  switch (status) {
    case 200:
      return "OK";
    case 204:
      return "No Content";
    case 304:
      return "Not Modified";
    case 400:
      return "Bad Request";
    case 401:
      return "Unauthorized";
    case 403:
      return "Forbidden";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 408:
      return "Request Timeout";
    case 409:
      return "Conflict";
    case 411:
      return "Length Required";
    case 413:
      return "Content Too Large";
    case 414:
      return "URI Too Long";
    case 415:
      return "Unsupported Media Type";
    case 417:
      return "Expectation Failed";
    case 421:
      return "Misdirected Request";
    case 429:
      return "Too Many Requests";
    case 431:
      return "Request Header Fields Too Large";
    case 499:
      return "Client Closed Request";
    case 500:
      return "Internal Server Error";
    case 501:
      return "Not Implemented";
    case 503:
      return "Service Unavailable";
    case 504:
      return "Gateway Timeout";
    case 505:
      return "HTTP Version Not Supported";
    default:
      return "Status";
  }
}

grpc::StatusCode code_of(int status) {
  switch (status) {
    case 403:
      return grpc::StatusCode::PERMISSION_DENIED;
    case 404:
      return grpc::StatusCode::NOT_FOUND;
    case 408:
      return grpc::StatusCode::ABORTED;
    case 413:
      return grpc::StatusCode::RESOURCE_EXHAUSTED;
    case 501:
      return grpc::StatusCode::UNIMPLEMENTED;
    case 503:
      return grpc::StatusCode::UNAVAILABLE;
    default:
      return grpc::StatusCode::INVALID_ARGUMENT;
  }
}

}  // namespace

HttpAnswer refusal_answer(const HttpRefusal& refusal) {
  return {refusal.status, "application/json",
          error_json({code_of(refusal.status), refusal.message}, "") + "\n"};
}

std::string answer_head(int status,
                        absl::string_view type,
                        absl::string_view length,
                        bool keep_alive,
                        const HttpHeaders& headers) {
  std::string head = absl::StrCat("HTTP/1.1 ", status, " ", words_of_status(status), "\r\n");
  if (!type.empty()) absl::StrAppend(&head, "Content-Type: ", type, "\r\n");
  absl::StrAppend(&head,
                  length == kChunked ? "Transfer-Encoding: " : "Content-Length: ", length,
                  "\r\nContent-Security-Policy: ", kPolicy,
                  "\r\nX-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\n"
                  "Cross-Origin-Opener-Policy: same-origin\r\n");
  bool cached = false, shared = false;
  for (const auto& [name, value] : headers) {
    cached = cached || name == "Cache-Control";
    shared = shared || name == "Access-Control-Allow-Origin";
    absl::StrAppend(&head, name, ": ", value, "\r\n");
  }
  if (!cached) absl::StrAppend(&head, "Cache-Control: no-store\r\n");
  if (!shared) absl::StrAppend(&head, "Cross-Origin-Resource-Policy: same-origin\r\n");
  if (!keep_alive) absl::StrAppend(&head, "Connection: close\r\n");
  return head + "\r\n";
}

}  // namespace tet
