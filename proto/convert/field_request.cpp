#include "proto/convert/field_request.h"

#include <utility>

#include <absl/strings/escaping.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "proto/convert/request.h"
#include "proto/convert/status.h"
#include "proto/wire/sha256.h"

namespace tet {

namespace {

std::string field_path(std::size_t i) { return absl::StrFormat("%s[%d]", kFieldsField, i); }

/// Whether the name of the file that it is in can be one.
absl::Status check_file(const v1::MeshRequest& request, std::size_t i) {
  const std::string& grid = request.fields(static_cast<int>(i)).grid();
  if (grid.empty()) {
    if (!request.has_scene()) return absl::OkStatus();
    return invalid_field(absl::StrCat(field_path(i), ".grid must be set: a scene has no file"));
  }
  if (!digest_of_name(grid).empty()) return absl::OkStatus();
  return invalid_field(absl::StrCat(field_path(i), ".grid \"", grid.substr(0, 100),
                                    "\" is not grids/ and 64 lower-case hexadecimal digits"));
}

}  // namespace

absl::Status parse_fields(const v1::MeshRequest& request, MeshRequest& out) {
  for (const v1::Field& field : request.fields()) {
    out.fields.push_back({field.name(), field.grid(), field.grid_name()});
  }
  if (const auto status = check_fields(out.fields); !status.ok()) {
    return invalid_field(std::string(status.message()));
  }
  for (std::size_t i = 0; i < out.fields.size(); ++i) {
    if (auto status = check_file(request, i); !status.ok()) return status;
  }
  return absl::OkStatus();
}

void to_proto(std::span<const VertexField> fields, v1::MeshRequest& message) {
  for (const VertexField& field : fields) {
    v1::Field& added = *message.add_fields();
    added.set_name(field.name);
    added.set_grid(field.file);
    added.set_grid_name(field.grid);
  }
}

void set_canonical_fields(std::span<const VertexField> fields, v1::MeshRequest& canonical) {
  const std::vector<FieldArray> arrays = arrays_of(fields);
  for (std::size_t i = 0; i < fields.size(); ++i) {
    v1::Field& field = *canonical.add_fields();
    field.set_name(arrays[i].name);
    field.set_grid(fields[i].file.empty() ? canonical.name() : fields[i].file);
    field.set_grid_name(fields[i].components.front()->name);
  }
}

std::string exact_fields(const v1::MeshRequest& request) {
  std::string text;
  for (const v1::Field& field : request.fields()) {
    absl::StrAppend(&text, " field ", absl::BytesToHexString(field.SerializeAsString()));
  }
  return text;
}

}  // namespace tet
