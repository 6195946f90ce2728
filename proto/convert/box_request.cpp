#include "proto/convert/box_request.h"

#include <absl/status/status.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "proto/convert/points.h"
#include "proto/convert/status.h"

namespace tet {
namespace {

std::string text_of(const v1::Point& point) {
  return absl::StrFormat("(%g, %g, %g)", point.x(), point.y(), point.z());
}

absl::Status check_box(const v1::MeshRequest& request) {
  const v1::Point &min = request.box().min(), &max = request.box().max();
  const std::string what =
      absl::StrCat("box from min ", text_of(min), " to max ", text_of(max));
  if (!request.box().has_min() || !request.box().has_max()) {
    return invalid_field("box must have both min and max");
  }
  if (!is_finite(min) || !is_finite(max)) {
    return invalid_field(absl::StrCat(what, " is not finite"));
  }
  if (!(min.x() < max.x() && min.y() < max.y() && min.z() < max.z())) {
    return invalid_field(absl::StrCat(what, " is empty: min must be below max on every axis"));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::optional<WorldPoint>> parse_origin(const v1::MeshRequest& request) {
  if (!request.has_origin()) return std::nullopt;
  if (is_finite(request.origin())) return from_proto(request.origin());
  return invalid_field(absl::StrCat("origin ", text_of(request.origin()), " is not finite"));
}

absl::StatusOr<std::optional<WorldBox>> parse_box(const v1::MeshRequest& request) {
  if (!request.has_box()) return std::nullopt;
  if (const auto status = check_box(request); !status.ok()) return status;
  return from_proto(request.box());
}

std::string exact_box(const v1::MeshRequest& request) {
  if (!request.has_box()) return "";
  const v1::Point &min = request.box().min(), &max = request.box().max();
  return absl::StrFormat("%a %a %a %a %a %a", min.x(), min.y(), min.z(), max.x(), max.y(),
                         max.z());
}

std::string exact_origin(const v1::MeshRequest& request) {
  if (!request.has_origin()) return "";
  const v1::Point& origin = request.origin();
  return absl::StrFormat(" origin %a %a %a", origin.x(), origin.y(), origin.z());
}

}  // namespace tet
