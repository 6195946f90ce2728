#include "proto/convert/sizing_request.h"

#include <utility>

#include <absl/strings/escaping.h>
#include <absl/strings/str_cat.h>

#include "proto/convert/request.h"
#include "proto/convert/status.h"
#include "proto/sizing/sizing_message.h"

namespace tet {

namespace {

/// Whether the name of the file that a grid of sizes is in can be one.
absl::Status check_sizing_grid(const v1::MeshRequest& request) {
  if (!request.sizing().has_grid()) return absl::OkStatus();
  const std::string& name = request.sizing().grid().name();
  if (!name.empty()) {
    return within_field("sizing", within_field("grid", parse_grid_name(name).status()));
  }
  if (!request.has_scene()) return absl::OkStatus();
  return invalid_field("sizing.grid.name must be set: a scene has no file");
}

}  // namespace

absl::Status parse_sizing(const v1::MeshRequest& request, MeshRequest& out) {
  if (!request.has_sizing()) return absl::OkStatus();
  absl::StatusOr<Sizing> sizing = sizing_of_message(request.sizing());
  absl::Status status = sizing.status();
  if (status.ok() && request.has_spacing()) status = check_sizing(*sizing, request.spacing());
  if (!status.ok()) {
    return within_field(kSizingField, invalid_field(std::string(status.message())));
  }
  out.sizing = *std::move(sizing);
  return check_sizing_grid(request);
}

void set_canonical_sizing(const Sizing& sizing, v1::MeshRequest& canonical) {
  if (!sizing.any()) return;
  *canonical.mutable_sizing() = message_of_sizing(sizing);
  if (!sizing.grid) return;
  v1::SizingGrid& grid = *canonical.mutable_sizing()->mutable_grid();
  if (grid.name().empty()) grid.set_name(canonical.name());
  grid.set_grid_name(sizing.grid->volume->name);
}

std::string exact_sizing(const v1::MeshRequest& request) {
  if (!request.has_sizing()) return "";
  return absl::StrCat(" sizing ", absl::BytesToHexString(request.sizing().SerializeAsString()));
}

}  // namespace tet
