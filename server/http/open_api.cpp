#include "server/http/open_api.h"

#include <set>
#include <string_view>

#include <absl/strings/ascii.h>
#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>
#include <google/protobuf/descriptor.h>
#include <nlohmann/json.hpp>

#include "server/http/json_routes.h"

namespace tet {

namespace {

namespace pb = google::protobuf;
using Json = nlohmann::ordered_json;

std::string ref_of(const std::string& full_name) {
  return absl::StrCat("#/components/schemas/", full_name);
}

Json enum_schema(const pb::EnumDescriptor& type) {
  Json names = Json::array();
  for (int i = 0; i < type.value_count(); ++i) names.push_back(type.value(i)->name());
  return {{"type", "string"}, {"enum", names}};
}

/// Fills in the schemas of messages and what they are made of.
class Schemas {
 public:
  Json of_message(const pb::Descriptor& type) {
    const std::string& name = type.full_name();
    if (absl::StartsWith(name, "google.protobuf.")) return well_known(name);
    if (!all_.contains(name)) {
      all_[name] = Json{{"type", "object"}};  // before its fields, which may lead back to it
      Json fields = Json::object();
      for (int i = 0; i < type.field_count(); ++i) {
        fields[type.field(i)->json_name()] = of_field(*type.field(i));
      }
      all_[name]["properties"] = fields;
      all_[name]["additionalProperties"] = false;
    }
    return {{"$ref", ref_of(name)}};
  }

  Json take() { return std::move(all_); }

 private:
  static Json well_known(const std::string& name) {
    if (absl::EndsWith(name, "Timestamp")) return {{"type", "string"}, {"format", "date-time"}};
    if (absl::EndsWith(name, "Duration")) return {{"type", "string"}, {"pattern", "s$"}};
    return {{"type", "object"}};
  }

  Json of_field(const pb::FieldDescriptor& field) {
    if (field.is_map()) {
      return {{"type", "object"},
              {"additionalProperties", of_value(*field.message_type()->map_value())}};
    }
    if (field.is_repeated()) return {{"type", "array"}, {"items", of_value(field)}};
    return of_value(field);
  }

  Json of_value(const pb::FieldDescriptor& field) {
    switch (field.cpp_type()) {
      case pb::FieldDescriptor::CPPTYPE_MESSAGE:
        return of_message(*field.message_type());
      case pb::FieldDescriptor::CPPTYPE_ENUM:
        return enum_schema(*field.enum_type());
      case pb::FieldDescriptor::CPPTYPE_BOOL:
        return {{"type", "boolean"}};
      case pb::FieldDescriptor::CPPTYPE_DOUBLE:
      case pb::FieldDescriptor::CPPTYPE_FLOAT:
        return {{"type", {"number", "string"}}, {"format", field.cpp_type_name()}};
      case pb::FieldDescriptor::CPPTYPE_INT32:
      case pb::FieldDescriptor::CPPTYPE_UINT32:
        return {{"type", "integer"}, {"format", field.cpp_type_name()}};
      case pb::FieldDescriptor::CPPTYPE_INT64:
      case pb::FieldDescriptor::CPPTYPE_UINT64:
        return {{"type", "string"}, {"format", field.cpp_type_name()}};
      case pb::FieldDescriptor::CPPTYPE_STRING:
        break;
    }
    if (field.type() != pb::FieldDescriptor::TYPE_BYTES) return {{"type", "string"}};
    return {{"type", "string"}, {"contentEncoding", "base64"}};
  }

  Json all_ = Json::object();
};

Json content_of(Json schema) { return {{"application/json", {{"schema", std::move(schema)}}}}; }

Json operation_of(const JsonRoute& route, Schemas& schemas) {
  const pb::MethodDescriptor& method = *find_method(route.method);
  Json operation{{"operationId", absl::StrCat(route.verb, " ", method.name())},
                 {"x-grpc-method", method.full_name()},
                 {"parameters", Json::array()}};
  const bool has_id = absl::StrContains(route.path, "{id}");
  if (has_id) {
    operation["parameters"].push_back(
        {{"name", "id"}, {"in", "path"}, {"required", true}, {"schema", {{"type", "string"}}}});
  }
  const Json input = schemas.of_message(*method.input_type());
  if (route.verb == "POST") {
    operation["requestBody"] = {{"content", content_of(input)}};
  } else {
    for (int i = 0; i < method.input_type()->field_count(); ++i) {
      const pb::FieldDescriptor& field = *method.input_type()->field(i);
      const bool text = field.message_type() == nullptr ||
                        field.message_type()->full_name() == "google.protobuf.Duration";
      const bool scalar = !field.is_repeated() && text;
      if (!scalar || (has_id && field.name() == "name")) continue;
      operation["parameters"].push_back(
          {{"name", field.json_name()}, {"in", "query"}, {"schema", {{"type", "string"}}}});
    }
  }
  operation["responses"] = {
      {"200",
       {{"description", method.output_type()->name()},
        {"content", content_of(schemas.of_message(*method.output_type()))}}},
      {"default",
       {{"description", "A refusal"}, {"content", content_of({{"$ref", ref_of("Refusal")}})}}}};
  return operation;
}

Json refusal_schema() {
  const Json text{{"type", "string"}};
  return {{"type", "object"},
          {"properties",
           {{"error",
             {{"type", "object"},
              {"properties",
               {{"code", {{"type", "integer"}}},
                {"message", text},
                {"reason", text},
                {"request_id", text},
                {"details", {{"type", "array"}, {"items", {{"type", "object"}}}}}}}}}}}};
}

/// The one path that is no method's: the bytes of a file.
Json upload_operation(Schemas& schemas) {
  const pb::MethodDescriptor& method = *find_method("tetstream.v1.GridService/UploadGrid");
  return {
      {"operationId", "PUT UploadGrid"},
      {"x-grpc-method", method.full_name()},
      {"parameters",
       {{{"name", "id"}, {"in", "path"}, {"required", true}, {"schema", {{"type", "string"}}}},
        {{"name", "Content-Range"}, {"in", "header"}, {"schema", {{"type", "string"}}}}}},
      {"requestBody", {{"content", {{"application/octet-stream", Json::object()}}}}},
      {"responses",
       {{"200",
         {{"description", "UploadGridResponse"},
          {"content", content_of(schemas.of_message(*method.output_type()))}}},
        {"default",
         {{"description", "A refusal"},
          {"content", content_of({{"$ref", ref_of("Refusal")}})}}}}}};
}

}  // namespace

std::string open_api() {
  Schemas schemas;
  Json paths = Json::object();
  for (const JsonRoute& route : json_routes()) {
    paths[std::string(route.path)][absl::AsciiStrToLower(route.verb)] =
        operation_of(route, schemas);
  }
  paths["/v1/grids/{id}"]["put"] = upload_operation(schemas);
  Json all = schemas.take();
  all["Refusal"] = refusal_schema();
  const Json document{
      {"openapi", "3.1.0"},
      {"info", {{"title", "tetstream"}, {"version", TETSTREAM_VERSION}}},
      {"security", {{{"bearer", Json::array()}}, Json::object()}},
      {"paths", paths},
      {"components",
       {{"schemas", all},
        {"securitySchemes", {{"bearer", {{"type", "http"}, {"scheme", "bearer"}}}}}}}};
  return document.dump(1) + "\n";
}

}  // namespace tet
