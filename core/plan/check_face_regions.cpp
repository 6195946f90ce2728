#include "core/plan/check_face_regions.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include <absl/strings/ascii.h>
#include <absl/strings/escaping.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_join.h>
#include <absl/strings/string_view.h>

#include "core/mesh/find_faces.h"
#include "core/plan/vertex_field.h"

namespace tet {
namespace {

/// Lengths beyond these are no world's.
constexpr double kLeastLength = 1e-15, kMostLength = 1e15;

bool is_coordinate(double value) { return std::abs(value) <= kMostLength; }

bool is_place(const WorldPoint& p) {
  return is_coordinate(p.x) && is_coordinate(p.y) && is_coordinate(p.z);
}

std::string text_of(const WorldPoint& p) {
  return absl::StrFormat("(%g, %g, %g)", p.x, p.y, p.z);
}

/// Looks at one region; the first complaint stays.
class RegionCheck {
 public:
  explicit RegionCheck(std::size_t index)
      : path_(absl::StrFormat("%s[%d]", kFaceRegionsField, index)) {}

  absl::Status check(const FaceRegion& region) {
    check_name(region.name);
    if (!region.has_condition() && !region.creases) {
      say("",
          "has no condition: set box, ball, cylinder, half_space, "
          "nearest, facing, node or creases");
    }
    if (region.box) check(*region.box);
    if (region.ball) check(*region.ball);
    if (region.cylinder) check(*region.cylinder);
    if (region.half_space) check(*region.half_space);
    if (region.facing) check(*region.facing);
    if (region.creases) check(*region.creases);
    for (std::size_t i = 0; i < region.nearest.size(); ++i) {
      place(absl::StrCat("nearest.points[", 3 * i, "]"), region.nearest[i]);
    }
    return status_;
  }

 private:
  void check_name(const std::string& name) {
    const std::string quoted =
        absl::StrCat("\"", absl::CHexEscape(name.substr(0, FaceRegion::kMaxNameBytes)), "\"");
    if (name.size() > FaceRegion::kMaxNameBytes || !is_array_name(name)) {
      say("name", absl::StrFormat("%s cannot name faces: it takes UTF-8 of 1 to %d bytes "
                                  "without control characters, / and quotes",
                                  quoted, FaceRegion::kMaxNameBytes));
    }
    for (const bool both_sides : {false, true}) {
      const auto labels = face_labels_of(both_sides, true);
      if (std::ranges::find(labels, name, &FaceLabel::name) == labels.end()) continue;
      say("name", quoted + " is a name that faces have anyway: call the region otherwise");
    }
  }

  void check(const WorldBox& box) {
    place("box.min", box.min);
    place("box.max", box.max);
    const auto& [min, max] = box;
    if (min.x < max.x && min.y < max.y && min.z < max.z) return;
    say("box", absl::StrFormat("from min %s to max %s is empty: min must be below max on every "
                               "axis",
                               text_of(min), text_of(max)));
  }

  void check(const FaceRegion::Ball& ball) {
    place("ball.centre", ball.centre);
    positive("ball.radius", ball.radius);
  }

  void check(const FaceRegion::Cylinder& cylinder) {
    place("cylinder.start", cylinder.start);
    place("cylinder.end", cylinder.end);
    positive("cylinder.radius", cylinder.radius);
    const WorldPoint &from = cylinder.start, &to = cylinder.end;
    const double length = std::hypot(to.x - from.x, to.y - from.y, to.z - from.z);
    if (length >= kLeastLength) return;
    say("cylinder", absl::StrFormat("from start %s to end %s has no length: an axis needs two "
                                    "ends",
                                    text_of(from), text_of(to)));
  }

  void check(const FaceRegion::HalfSpace& half_space) {
    direction("half_space.normal", half_space.normal);
    if (is_coordinate(half_space.offset)) return;
    say("half_space.offset", absl::StrFormat("%g is not from %g to %g", half_space.offset,
                                             -kMostLength, kMostLength));
  }

  void check(const FaceRegion::Facing& facing) {
    direction("facing.direction", facing.direction);
    if (facing.angle_deg >= 0 && facing.angle_deg <= 180) return;
    say("facing.angle_deg", absl::StrFormat("%g is not from 0 to 180", facing.angle_deg));
  }

  void check(const FaceRegion::Creases& creases) {
    if (creases.angle_deg >= 1 && creases.angle_deg <= 180) return;
    say("creases.angle_deg", absl::StrFormat("%g is not from 1 to 180", creases.angle_deg));
  }

  void place(const std::string& field, const WorldPoint& point) {
    if (is_place(point)) return;
    say(field, absl::StrFormat("%s is not from %g to %g along every axis", text_of(point),
                               -kMostLength, kMostLength));
  }

  void direction(const std::string& field, const WorldPoint& point) {
    const double length = std::hypot(point.x, point.y, point.z);
    if (is_place(point) && length >= kLeastLength) return;
    say(field, absl::StrFormat("%s is no direction: its length must be from %g to %g",
                               text_of(point), kLeastLength, kMostLength));
  }

  void positive(const std::string& field, double value) {
    if (value >= kLeastLength && value <= kMostLength) return;
    say(field, absl::StrFormat("%g is not from %g to %g", value, kLeastLength, kMostLength));
  }

  void say(const std::string& field, const std::string& what) {
    if (!status_.ok()) return;
    status_ = absl::InvalidArgumentError(
        absl::StrCat(path_, field.empty() ? "" : ".", field, " ", what));
  }

  const std::string path_;
  absl::Status status_;
};

/// Whether a name is a region's and a number, as those of its patches: `rim.7`.
bool may_be_patch_of(const std::string& name, const std::string& region) {
  const absl::string_view digits =
      absl::string_view(name).substr(std::min(name.size(), region.size() + 1));
  return name.starts_with(region + ".") && !digits.empty() &&
         std::ranges::all_of(digits, [](unsigned char c) { return absl::ascii_isdigit(c); });
}

/// A region's patches have names, too, and regions of one name are divided as one.
absl::Status check_creases(std::span<const FaceRegion> regions, std::size_t i) {
  for (std::size_t k = 0; k < regions.size(); ++k) {
    const FaceRegion &region = regions[i], &other = regions[k];
    if (other.creases && may_be_patch_of(region.name, other.name)) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "%s[%d].name \"%s\" may be that of a patch of %s[%d]: call the region otherwise",
          kFaceRegionsField, i, absl::CHexEscape(region.name), kFaceRegionsField, k));
    }
    if (other.name == region.name && other.creases != region.creases) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "%s[%d].creases are not those of %s[%d], which has the same name: set them alike",
          kFaceRegionsField, i, kFaceRegionsField, k));
    }
  }
  return absl::OkStatus();
}

/// The first few, for a message.
std::string list_of(std::span<const std::string> nodes) {
  constexpr std::size_t kMost = 16;
  std::vector<std::string> named;
  for (const std::string& node : nodes) {
    if (!node.empty()) named.push_back(absl::CHexEscape(node));
  }
  const std::size_t more = named.size() - std::min(named.size(), kMost);
  named.resize(named.size() - more);
  return absl::StrCat(absl::StrJoin(named, ", "),
                      more > 0 ? absl::StrCat(" and ", more, " more") : "");
}

}  // namespace

absl::Status check_face_nodes(std::span<const FaceRegion> regions,
                              std::span<const std::string> nodes) {
  constexpr std::size_t kShownBytes = 64;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const std::string& node = regions[i].node;
    if (node.empty() || std::ranges::find(nodes, node) != nodes.end()) continue;
    const std::string what = absl::StrFormat("%s[%d].node \"%s\"", kFaceRegionsField, i,
                                             absl::CHexEscape(node.substr(0, kShownBytes)));
    if (nodes.empty()) {
      return absl::InvalidArgumentError(absl::StrCat(
          what, " is a node of a scene, and a grid has none: say where the faces lie"));
    }
    return absl::InvalidArgumentError(
        absl::StrCat(what, " is no node of the scene, which has ", list_of(nodes)));
  }
  return absl::OkStatus();
}

absl::Status check_face_regions(std::span<const FaceRegion> regions) {
  if (regions.size() > FaceRegion::kMaxRegions) {
    return absl::InvalidArgumentError(absl::StrFormat("%s has %d entries; the limit is %d",
                                                      kFaceRegionsField, regions.size(),
                                                      FaceRegion::kMaxRegions));
  }
  std::size_t points = 0;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    points += regions[i].nearest.size();
    if (points > FaceRegion::kMaxPoints) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "%s[%d].nearest.points makes %d points of all regions; the limit is %d",
          kFaceRegionsField, i, points, FaceRegion::kMaxPoints));
    }
    if (auto status = RegionCheck(i).check(regions[i]); !status.ok()) return status;
    if (auto status = check_creases(regions, i); !status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::Status check_part_labels(const MeshHeader& header) {
  if (header.face_regions.empty()) return absl::OkStatus();
  if (header.face_labels.size() > kMaxFaceLabels) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "%s: %d grids have %d names of faces together; the limit is %d. Name fewer regions, or "
        "mesh fewer grids at a time",
        kFaceRegionsField, header.parts.size(), header.face_labels.size(), kMaxFaceLabels));
  }
  std::set<std::string> names;
  for (const FaceLabel& label : header.face_labels) {
    if (names.insert(label.name).second) continue;
    return absl::InvalidArgumentError(absl::StrFormat(
        "%s: faces of two grids would both be called '%s': call the region otherwise",
        kFaceRegionsField, absl::CHexEscape(label.name)));
  }
  return absl::OkStatus();
}

}  // namespace tet
