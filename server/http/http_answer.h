// Answers, and the headers that every one has.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <absl/strings/string_view.h>
#include <grpcpp/support/slice.h>

#include "server/http/request_head.h"

namespace tet {

using HttpHeaders = std::vector<std::pair<std::string, std::string>>;

struct HttpAnswer {
  int status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::string body;
  HttpHeaders headers = {};  ///< beside those of every answer
  grpc::Slice kept = {};     ///< in place of `body`, where all who ask share the bytes
};

/// Returns a refusal as JSON, in the shape of error_json.
HttpAnswer refusal_answer(const HttpRefusal& refusal);

/// How a body is told to end.
inline constexpr absl::string_view kChunked = "chunked";

/// Returns the status line and all headers: what browsers may do with the answer, then
/// `headers`. `length` is the body's size as text, or kChunked.
std::string answer_head(int status,
                        absl::string_view type,
                        absl::string_view length,
                        bool keep_alive,
                        const HttpHeaders& headers);

}  // namespace tet
