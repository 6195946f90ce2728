// Requests that become calls of the service.
#pragma once

#include <memory>
#include <variant>

#include "server/http/exchange.h"

namespace tet {

using MadeExchange = std::variant<std::shared_ptr<Exchange>, HttpRefusal>;

/// A unary or server-streaming method as gRPC-Web has it.
MadeExchange grpc_web_exchange(const HttpPlace& place,
                               const RequestHead& head,
                               AnswerStream& stream);

/// A unary method as JSON.
MadeExchange json_exchange(const HttpPlace& place,
                           const RequestHead& head,
                           AnswerStream& stream);

/// PUT /v1/grids/{sha256}: a file, or with a Content-Range the part of it that begins where the
/// last try ended.
MadeExchange upload_exchange(const HttpPlace& place,
                             const RequestHead& head,
                             AnswerStream& stream);

/// /metrics, for whoever may call GetCapabilities.
MadeExchange metrics_exchange(const HttpPlace& place,
                              const RequestHead& head,
                              AnswerStream& stream);

}  // namespace tet
