#include "client/command/arguments/field_options.h"

#include <absl/strings/str_cat.h>

#include "client/command/arguments/mesh_input.h"
#include "client/command/arguments/scene_input.h"
#include "client/command/arguments/surface_input.h"
#include "client/command/arguments/volume_file.h"

namespace tet {
namespace {

bool is_grid_file(const std::string& text) {
  return is_volume_file(text) || !stored_grid_name(text).empty();
}

/// Where the file's name ends; npos where none is named.
std::size_t end_of_file_name(const std::string& text) {
  std::size_t at = text.find(':');
  while (at != std::string::npos && !is_grid_file(text.substr(0, at))) {
    at = text.find(':', at + 1);
  }
  return at;
}

VertexField parse_field(const std::string& option) {
  VertexField field;
  std::string rest = option;
  if (const std::size_t at = rest.find('='); at != std::string::npos) {
    field.name = rest.substr(0, at);
    rest = rest.substr(at + 1);
  }
  const std::size_t at = end_of_file_name(rest);
  if (at != std::string::npos) field.file = rest.substr(0, at);
  field.grid = at == std::string::npos ? rest : rest.substr(at + 1);
  return field;
}

absl::Status check_field_file(const VertexField& field, const std::string& input) {
  if (!field.file.empty() || is_grid_file(input)) return absl::OkStatus();
  if (!is_scene_file(input) && !is_surface_file(input)) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      "--field ", field.grid, ": ", input,
      " has no grids: name the .vdb of the field's as --field FILE.vdb:", field.grid));
}

}  // namespace

absl::StatusOr<std::vector<VertexField>> understand_fields(
    const std::vector<std::string>& options) {
  std::vector<VertexField> fields;
  fields.reserve(options.size());
  for (const std::string& option : options) fields.push_back(parse_field(option));
  if (absl::Status status = check_fields(fields); !status.ok()) {
    return absl::InvalidArgumentError(absl::StrCat("--field: ", status.message()));
  }
  return fields;
}

absl::Status check_field_files(std::span<const VertexField> fields, const std::string& input) {
  for (const VertexField& field : fields) {
    if (auto status = check_field_file(field, input); !status.ok()) return status;
  }
  return absl::OkStatus();
}

}  // namespace tet
