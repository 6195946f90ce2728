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

/// Refuses names that no grid can have.
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
  order.grid_names = {request.grid_names().begin(), request.grid_names().end()};
  if (auto status = check_lengths(order.grid_names); !status.ok()) return status;
  const absl::Status status = check_grid_names(order.grid_names);
  return status.ok() ? status : invalid_field(std::string(status.message()));
}

void set_canonical_grids(const MeshOrder& order,
                         const GridList& grids,
                         v1::MeshRequest& canonical) {
  canonical.set_name(name_of_grid(order.digest));
  for (const auto& grid : grids) canonical.add_grid_names(grid->name);
  if (order.request.iso) canonical.set_iso(*order.request.iso);
  if (order.request.inside) {
    canonical.set_inside(*order.request.inside == InsideSide::kAbove ? v1::INSIDE_ABOVE
                                                                     : v1::INSIDE_BELOW);
  }
  if (order.request.spacing) canonical.set_spacing(*order.request.spacing);
}

std::string exact_grids(const v1::MeshRequest& canonical) {
  std::string text;
  if (canonical.grid_names().empty()) return text;
  // A number that is unset means another than any that is set: each grid has its own.
  absl::StrAppend(&text, " grids ", int{canonical.has_spacing()}, int{canonical.has_iso()});
  for (const std::string& name : canonical.grid_names()) {
    absl::StrAppend(&text, " ", absl::BytesToHexString(name));
  }
  return text;
}

}  // namespace tet
