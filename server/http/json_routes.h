// The unary methods as JSON over HTTP: which path is which method, and messages as text.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <variant>

#include <absl/status/statusor.h>
#include <absl/strings/string_view.h>
#include <google/protobuf/descriptor.h>
#include <grpcpp/support/status.h>

#include "server/http/grpc_web.h"
#include "server/http/request_head.h"

namespace tet {

/// One method. In its path {id} stands for what follows `prefix` in the field `name`.
struct JsonRoute {
  absl::string_view verb, path, method;
  absl::string_view prefix = {};  ///< "jobs/" or "grids/"
};

/// Every unary method once.
std::span<const JsonRoute> json_routes();

/// A request as the service takes it.
struct JsonCall {
  const google::protobuf::MethodDescriptor* method = nullptr;
  std::string message;  ///< serialized
};

/// Returns the method of this name: "tetstream.v1.JobService/GetJob". Null where there is none.
const google::protobuf::MethodDescriptor* find_method(absl::string_view name);

/// Whether the path is one of the JSON methods', by whatever verb.
bool is_json_path(absl::string_view path);

/// Finds the method, and reads the body or the query into its message.
std::variant<JsonCall, HttpRefusal> read_json_call(const RequestHead& head,
                                                   absl::string_view body);

/// Returns a serialized message as JSON, fields that are unset left out.
/// Errors: kInternal (bytes that are no such message).
absl::StatusOr<std::string> to_json(const google::protobuf::Descriptor& type,
                                    const std::string& message);

/// Returns {"error": {"code", "status", "message", "reason", "request_id", "details"}}.
std::string error_json(const grpc::Status& status, absl::string_view request_id);

/// Returns the status of HTTP that says nearly the same.
int http_status_of(grpc::StatusCode code) noexcept;

}  // namespace tet
