#include "proto/convert/grid_names_request.h"

#include <absl/strings/escaping.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/plan/joined/joined_plan.h"
#include "core/volume/grid_info.h"
#include "proto/convert/status.h"
#include "proto/wire/sha256.h"

namespace tet {

namespace {

std::string name_path(std::size_t i) { return absl::StrFormat("%s[%d]", kGridNamesField, i); }

/// What no grid can be called.
absl::Status check_lengths(const std::vector<std::string>& names) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].size() <= kMaxGridNameBytes) continue;
    return invalid_field(absl::StrFormat("%s has %d bytes; the limit is %d", name_path(i),
                                         names[i].size(), kMaxGridNameBytes));
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status parse_grid_names(const v1::MeshRequest& request, MeshOrder& order) {
  if (request.grid_names().empty()) return absl::OkStatus();
  if (request.has_scene()) {
    return invalid_field(absl::StrCat(kGridNamesField, " is set, but a scene has no grids"));
  }
  if (!request.grid_name().empty()) {
    return invalid_field("grid_name is set beside grid_names: set one of them");
  }
  order.grid_names = {request.grid_names().begin(), request.grid_names().end()};
  if (auto status = check_lengths(order.grid_names); !status.ok()) return status;
  absl::Status status = check_grid_names(order.grid_names);
  if (status.ok()) status = check_joined_request(order.request);
  return status.ok() ? status : invalid_field(std::string(status.message()));
}

absl::Status check_stream_of_grids(const v1::StreamMeshRequest& request) {
  if (request.mesh().grid_names().empty()) return absl::OkStatus();
  if (request.encoding() == v1::ENCODING_COMPACT) {
    return invalid_field(
        "encoding ENCODING_COMPACT is for one grid: ask for ENCODING_PACKED, or leave "
        "mesh.grid_names unset");
  }
  if (request.base_name().empty()) return absl::OkStatus();
  return invalid_field("base_name is for one grid: the meshes of several are sent whole");
}

absl::Status check_session_of_grids(const v1::MeshRequest& request) {
  if (request.grid_names().empty()) return absl::OkStatus();
  return invalid_field("grid_names is set, but a session follows one grid: set grid_name");
}

void set_canonical_grids(const MeshOrder& order,
                         const GridList& grids,
                         v1::MeshRequest& canonical) {
  canonical.set_name(name_of_grid(order.digest));
  for (const auto& grid : grids) canonical.add_grid_names(grid->name);
  if (order.request.iso) canonical.set_iso(*order.request.iso);
  if (order.request.spacing) canonical.set_spacing(*order.request.spacing);
}

std::string exact_grids(const v1::MeshRequest& canonical) {
  std::string text;
  if (canonical.grid_names().empty()) return text;
  // What is unset is no number's default here.
  absl::StrAppend(&text, " grids ", int{canonical.has_spacing()}, int{canonical.has_iso()});
  for (const std::string& name : canonical.grid_names()) {
    absl::StrAppend(&text, " ", absl::BytesToHexString(name));
  }
  return text;
}

}  // namespace tet
