#include "server/http/json_routes.h"

#include <memory>

#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_split.h>
#include <absl/strings/string_view.h>
#include <google/protobuf/message.h>
#include <google/protobuf/util/json_util.h>
#include <nlohmann/json.hpp>

#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "tetstream/v1/grids.pb.h"
#include "tetstream/v1/jobs.pb.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

namespace {

namespace pb = google::protobuf;
namespace v1 = ::tetstream::v1;

constexpr absl::string_view kId = "{id}";
constexpr std::size_t kMostIdBytes = 128;
// Deeper ones are no message of ours, and would take the stack.
constexpr int kDeepestJson = 64;

constexpr JsonRoute kRoutes[] = {
    {"GET", "/v1/capabilities", "tetstream.v1.MeshService/GetCapabilities"},
    {"POST", "/v1/meshes:estimate", "tetstream.v1.MeshService/EstimateMesh"},
    {"POST", "/v1/grids:findMissing", "tetstream.v1.GridService/FindMissingGrids"},
    {"GET", "/v1/grids", "tetstream.v1.GridService/ListGrids"},
    {"GET", "/v1/grids/{id}", "tetstream.v1.GridService/GetGridInfo", "grids/"},
    {"GET", "/v1/grids/{id}:upload", "tetstream.v1.GridService/GetUploadStatus", "grids/"},
    {"POST", "/v1/jobs", "tetstream.v1.JobService/CreateJob"},
    {"GET", "/v1/jobs", "tetstream.v1.JobService/ListJobs"},
    {"POST", "/v1/jobs:list", "tetstream.v1.JobService/ListJobs"},
    {"GET", "/v1/jobs/{id}", "tetstream.v1.JobService/GetJob", "jobs/"},
    {"GET", "/v1/jobs/{id}:wait", "tetstream.v1.JobService/WaitJob", "jobs/"},
    {"POST", "/v1/jobs/{id}:cancel", "tetstream.v1.JobService/CancelJob", "jobs/"},
    {"POST", "/v1/jobs/{id}:retry", "tetstream.v1.JobService/RetryJob", "jobs/"},
    {"DELETE", "/v1/jobs/{id}", "tetstream.v1.JobService/DeleteJob", "jobs/"},
    {"GET", "/v1/jobs/{id}/deadShards", "tetstream.v1.JobService/ListDeadShards", "jobs/"},
    {"GET", "/v1/workers", "tetstream.v1.JobService/ListWorkers"},
};

/// Returns what stands for {id}, "" for a path without; none where the path is another one.
std::optional<absl::string_view> match(absl::string_view pattern, absl::string_view path) {
  const std::size_t at = pattern.find(kId);
  if (at == absl::string_view::npos) {
    return pattern == path ? std::optional<absl::string_view>("") : std::nullopt;
  }
  const absl::string_view before = pattern.substr(0, at);
  const absl::string_view after = pattern.substr(at + kId.size());
  if (path.size() <= before.size() + after.size() || !absl::StartsWith(path, before) ||
      !absl::EndsWith(path, after)) {
    return std::nullopt;
  }
  path.remove_prefix(before.size());
  path.remove_suffix(after.size());
  const bool id =
      path.size() <= kMostIdBytes && path.find_first_of("/:%") == absl::string_view::npos;
  return id ? std::optional<absl::string_view>(path) : std::nullopt;
}

std::optional<HttpRefusal> add_query(absl::string_view query, nlohmann::json& fields) {
  if (query.empty()) return std::nullopt;
  for (const absl::string_view part : absl::StrSplit(query, '&')) {
    const std::pair<absl::string_view, absl::string_view> pair =
        absl::StrSplit(part, absl::MaxSplits('=', 1));
    const auto name = decode_query(pair.first), value = decode_query(pair.second);
    if (!name || !value || name->empty()) return HttpRefusal{400, "malformed query"};
    if (fields.contains(*name)) {
      return HttpRefusal{400, absl::StrCat("the query sets ", *name, " twice")};
    }
    fields[*name] = *value;
  }
  return std::nullopt;
}

/// Whether brackets go no deeper; what is in quotes does not count.
bool is_shallow(absl::string_view json) noexcept {
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (quoted) {
      if (c == '\\') ++i;
      if (c == '"') quoted = false;
    } else if (c == '"') {
      quoted = true;
    } else if (c == '{' || c == '[') {
      if (++depth > kDeepestJson) return false;
    } else if (c == '}' || c == ']') {
      --depth;
    }
  }
  return true;
}

std::variant<JsonCall, HttpRefusal> read_message(const JsonRoute& route,
                                                 const std::string& json,
                                                 absl::string_view id) {
  const pb::MethodDescriptor* method = find_method(route.method);
  if (method == nullptr) return HttpRefusal{501, "no such method"};
  const std::unique_ptr<pb::Message> message(
      pb::MessageFactory::generated_factory()->GetPrototype(method->input_type())->New());
  if (!is_shallow(json)) {
    return HttpRefusal{400, absl::StrCat("the JSON is nested deeper than ", kDeepestJson)};
  }
  const auto read = pb::util::JsonStringToMessage(json, message.get());
  if (!read.ok()) {
    return HttpRefusal{400, absl::StrCat("the JSON is no ", method->input_type()->name(), ": ",
                                         std::string(read.message()).substr(0, 300))};
  }
  if (!id.empty()) {
    const pb::FieldDescriptor* name = method->input_type()->FindFieldByName("name");
    message->GetReflection()->SetString(message.get(), name, absl::StrCat(route.prefix, id));
  }
  return JsonCall{method, message->SerializeAsString()};
}

}  // namespace

std::span<const JsonRoute> json_routes() { return kRoutes; }

const pb::MethodDescriptor* find_method(absl::string_view name) {
  // What no code mentions the linker would leave out.
  static const bool linked = v1::GridFile::descriptor() != nullptr &&
                             v1::Job::descriptor() != nullptr &&
                             v1::MeshHeader::descriptor() != nullptr &&
                             google::rpc::ErrorInfo::descriptor() != nullptr;
  static_cast<void>(linked);
  const std::pair<absl::string_view, absl::string_view> parts =
      absl::StrSplit(name, absl::MaxSplits('/', 1));
  const std::string service(parts.first);
  if (!absl::StartsWith(service, "tetstream.v1.")) return nullptr;
  const auto* found = pb::DescriptorPool::generated_pool()->FindServiceByName(service);
  return found == nullptr ? nullptr : found->FindMethodByName(std::string(parts.second));
}

bool is_json_path(absl::string_view path) { return absl::StartsWith(path, "/v1/"); }

std::variant<JsonCall, HttpRefusal> read_json_call(const RequestHead& head,
                                                   absl::string_view body) {
  bool known = false;
  for (const JsonRoute& route : kRoutes) {
    const auto id = match(route.path, head.path);
    if (!id) continue;
    known = true;
    if (route.verb != head.method) continue;
    if (route.verb == "POST") {
      if (!head.query.empty()) return HttpRefusal{400, "a POST has no query"};
      const bool empty = body.find_first_not_of(" \t\r\n") == absl::string_view::npos;
      return read_message(route, empty ? "{}" : std::string(body), *id);
    }
    nlohmann::json fields = nlohmann::json::object();
    if (auto refused = add_query(head.query, fields)) return *std::move(refused);
    return read_message(
        route, fields.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace), *id);
  }
  if (known) return HttpRefusal{405, absl::StrCat(head.method, " is not for this path")};
  return HttpRefusal{404, "there is nothing at this path; /v1/openapi.json says what there is"};
}

absl::StatusOr<std::string> to_json(const pb::Descriptor& type, const std::string& bytes) {
  const std::unique_ptr<pb::Message> message(
      pb::MessageFactory::generated_factory()->GetPrototype(&type)->New());
  std::string json;
  if (!message->ParseFromString(bytes) ||
      !pb::util::MessageToJsonString(*message, &json, {}).ok()) {
    return absl::InternalError(absl::StrCat("an answer is no ", type.name()));
  }
  return json;
}

std::string error_json(const grpc::Status& status, absl::string_view request_id) {
  nlohmann::ordered_json error{{"code", static_cast<int>(status.error_code())},
                               {"message", status.error_message()}};
  if (!request_id.empty()) error["request_id"] = request_id;
  google::rpc::Status details;
  if (details.ParseFromString(status.error_details())) {
    for (const auto& any : details.details()) {
      google::rpc::ErrorInfo info;
      if (any.UnpackTo(&info)) error["reason"] = info.reason();
      std::string json;
      if (!pb::util::MessageToJsonString(any, &json, {}).ok()) continue;
      error["details"].push_back(nlohmann::ordered_json::parse(json, nullptr, false));
    }
  }
  return nlohmann::ordered_json{{"error", error}}.dump(
      -1, ' ', true, nlohmann::json::error_handler_t::replace);
}

int http_status_of(grpc::StatusCode code) noexcept {
  switch (code) {
    case grpc::StatusCode::OK:
      return 200;
    case grpc::StatusCode::CANCELLED:
      return 499;
    case grpc::StatusCode::INVALID_ARGUMENT:
    case grpc::StatusCode::FAILED_PRECONDITION:
    case grpc::StatusCode::OUT_OF_RANGE:
      return 400;
    case grpc::StatusCode::DEADLINE_EXCEEDED:
      return 504;
    case grpc::StatusCode::NOT_FOUND:
      return 404;
    case grpc::StatusCode::ALREADY_EXISTS:
    case grpc::StatusCode::ABORTED:
      return 409;
    case grpc::StatusCode::PERMISSION_DENIED:
      return 403;
    case grpc::StatusCode::UNAUTHENTICATED:
      return 401;
    case grpc::StatusCode::RESOURCE_EXHAUSTED:
      return 429;
    case grpc::StatusCode::UNIMPLEMENTED:
      return 501;
    case grpc::StatusCode::UNAVAILABLE:
      return 503;
    default:
      return 500;
  }
}

}  // namespace tet
