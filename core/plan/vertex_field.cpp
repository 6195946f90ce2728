#include "core/plan/vertex_field.h"

#include <algorithm>

#include <absl/strings/ascii.h>
#include <absl/strings/escaping.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/base/utf8.h"
#include "core/plan/mesh_request.h"

namespace tet {
namespace {

/// Empty where nobody knows yet.
const std::string& name_of(const VertexField& field) {
  const bool by_grid = field.name.empty() && !field.components.empty();
  return by_grid ? field.components.front()->name : field.name;
}

std::string quoted(const std::string& name) {
  return absl::StrCat("\"", absl::CHexEscape(name.substr(0, VertexField::kMaxNameBytes)), "\"");
}

absl::Status wrong(std::size_t i, const std::string& what) {
  return absl::InvalidArgumentError(absl::StrFormat("%s[%d].%s", kFieldsField, i, what));
}

absl::Status check_name(std::span<const VertexField> fields, std::size_t i) {
  const std::string& name = name_of(fields[i]);
  if (name.empty() && fields[i].components.empty()) return absl::OkStatus();
  if (!is_array_name(name)) {
    return wrong(i, absl::StrFormat("name %s cannot name an array: it takes UTF-8 of 1 to %d "
                                    "bytes without control characters, / and quotes",
                                    quoted(name), VertexField::kMaxNameBytes));
  }
  if (name == kCutFaceArray) {
    return wrong(i, absl::StrFormat("name %s is that of the array that tells the faces of a "
                                    "box: call the field otherwise",
                                    quoted(name)));
  }
  for (std::size_t other = 0; other < i; ++other) {
    if (name_of(fields[other]) != name) continue;
    return wrong(i, absl::StrFormat("name %s is that of %s[%d], too: give them two names",
                                    quoted(name), kFieldsField, other));
  }
  return absl::OkStatus();
}

/// What loading makes of a grid, and what no other volume is.
bool is_loaded(const VertexField& field) {
  const auto& components = field.components;
  return !components.empty() &&
         std::all_of(components.begin(), components.end(), [&](const auto& volume) {
           return volume != nullptr && components_of(volume->kind) == components.size();
         });
}

}  // namespace

bool is_array_name(const std::string& name) {
  const bool fits = !name.empty() && name.size() <= VertexField::kMaxNameBytes && name != ".";
  return fits && is_utf8(name) && std::none_of(name.begin(), name.end(), [](unsigned char c) {
           return absl::ascii_iscntrl(c) || c == '/' || c == '"';
         });
}

absl::Status check_fields(std::span<const VertexField> fields) {
  if (fields.size() > VertexField::kMaxFields) {
    return absl::InvalidArgumentError(absl::StrFormat("%s has %d entries; the limit is %d",
                                                      kFieldsField, fields.size(),
                                                      VertexField::kMaxFields));
  }
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (auto status = check_name(fields, i); !status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::Status check_loaded_fields(std::span<const VertexField> fields) {
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (!is_loaded(fields[i])) return wrong(i, "grid is not loaded");
  }
  return check_fields(fields);
}

std::vector<FieldArray> arrays_of(std::span<const VertexField> fields) {
  std::vector<FieldArray> arrays;
  for (const VertexField& field : fields) {
    arrays.push_back({name_of(field), static_cast<std::uint32_t>(field.components.size())});
  }
  return arrays;
}

}  // namespace tet
