#include "proto/convert/face_regions.h"

#include <array>
#include <cstddef>
#include <utility>

#include <absl/strings/escaping.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/plan/check_face_regions.h"
#include "proto/scene/message_parts.h"

namespace tet {
namespace {

namespace v1 = ::tetstream::v1;

/// Reads one region; the first list of the wrong length stays as the complaint.
class FaceRegionReader {
 public:
  explicit FaceRegionReader(const v1::FaceRegion& region) : region_(region) {}

  FaceRegion region() {
    FaceRegion region{region_.name()};
    if (region_.has_box()) {
      region.box = {point("box.min", region_.box().min()),
                    point("box.max", region_.box().max())};
    }
    if (region_.has_ball()) {
      region.ball = {point("ball.centre", region_.ball().centre()), region_.ball().radius()};
    }
    if (region_.has_cylinder()) {
      region.cylinder = {point("cylinder.start", region_.cylinder().start()),
                         point("cylinder.end", region_.cylinder().end()),
                         region_.cylinder().radius()};
    }
    if (region_.has_half_space()) {
      region.half_space = {point("half_space.normal", region_.half_space().normal()),
                           region_.half_space().offset()};
    }
    if (region_.has_facing()) {
      region.facing = {point("facing.direction", region_.facing().direction()),
                       region_.facing().angle_deg()};
    }
    if (region_.has_nearest()) region.nearest = points(region_.nearest().points());
    region.node = region_.node();
    if (region_.has_creases()) region.creases = {region_.creases().angle_deg()};
    return region;
  }
  /// Empty if nothing was wrong.
  const std::string& complaint() const { return complaint_; }

 private:
  template <class Field>
  WorldPoint point(const char* field, const Field& given) {
    std::array<double, 3> at{};
    complain(read_three(field, given, at));
    return {at[0], at[1], at[2]};
  }

  template <class Field>
  std::vector<WorldPoint> points(const Field& given) {
    if (given.empty() || given.size() % 3 != 0) {
      complain(absl::StrCat("nearest.points has ", given.size(),
                            " numbers; it takes three a point"));
      return {};
    }
    if (static_cast<std::size_t>(given.size()) > 3 * FaceRegion::kMaxPoints) {
      complain(absl::StrCat("nearest.points has ", given.size() / 3,
                            " points; the limit of all regions is ", FaceRegion::kMaxPoints));
      return {};
    }
    std::vector<WorldPoint> points;
    for (int i = 0; i < given.size(); i += 3) {
      points.push_back({given[i], given[i + 1], given[i + 2]});
    }
    return points;
  }

  void complain(std::string what) {
    if (complaint_.empty()) complaint_ = std::move(what);
  }

  const v1::FaceRegion& region_;
  std::string complaint_;
};

template <class Field>
void write_point(const WorldPoint& point, Field& field) {
  for (const double at : {point.x, point.y, point.z}) field.Add(at);
}

void write(const FaceRegion& region, v1::FaceRegion& message) {
  message.set_name(region.name);
  if (region.box) {
    write_point(region.box->min, *message.mutable_box()->mutable_min());
    write_point(region.box->max, *message.mutable_box()->mutable_max());
  }
  if (region.ball) {
    write_point(region.ball->centre, *message.mutable_ball()->mutable_centre());
    message.mutable_ball()->set_radius(region.ball->radius);
  }
  if (region.cylinder) {
    v1::CylinderRegion& cylinder = *message.mutable_cylinder();
    write_point(region.cylinder->start, *cylinder.mutable_start());
    write_point(region.cylinder->end, *cylinder.mutable_end());
    cylinder.set_radius(region.cylinder->radius);
  }
  if (region.half_space) {
    write_point(region.half_space->normal, *message.mutable_half_space()->mutable_normal());
    message.mutable_half_space()->set_offset(region.half_space->offset);
  }
  if (region.facing) {
    write_point(region.facing->direction, *message.mutable_facing()->mutable_direction());
    message.mutable_facing()->set_angle_deg(region.facing->angle_deg);
  }
  message.set_node(region.node);
  if (region.creases) message.mutable_creases()->set_angle_deg(region.creases->angle_deg);
  for (const WorldPoint& point : region.nearest) {
    write_point(point, *message.mutable_nearest()->mutable_points());
  }
}

}  // namespace

absl::StatusOr<std::vector<FaceRegion>> face_regions_of(
    const google::protobuf::RepeatedPtrField<v1::FaceRegion>& messages) {
  if (static_cast<std::size_t>(messages.size()) > FaceRegion::kMaxRegions) {
    return absl::InvalidArgumentError(absl::StrFormat("%s has %d entries; the limit is %d",
                                                      kFaceRegionsField, messages.size(),
                                                      FaceRegion::kMaxRegions));
  }
  std::vector<FaceRegion> regions;
  for (const v1::FaceRegion& message : messages) {
    FaceRegionReader reader(message);
    regions.push_back(reader.region());
    if (reader.complaint().empty()) continue;
    return absl::InvalidArgumentError(absl::StrFormat("%s[%d].%s", kFaceRegionsField,
                                                      regions.size() - 1, reader.complaint()));
  }
  if (auto status = check_face_regions(regions); !status.ok()) return status;
  return regions;
}

void to_proto(std::span<const FaceRegion> regions, v1::MeshRequest& message) {
  for (const FaceRegion& region : regions) write(region, *message.add_face_regions());
}

absl::StatusOr<std::vector<FaceRegion>> face_regions_from_json(const std::string& json) {
  const auto message = message_from_json<v1::FaceRegions>(json, "list of face regions");
  if (!message.ok()) return message.status();
  return face_regions_of(message->regions());
}

std::string exact_face_regions(const v1::MeshRequest& request) {
  std::string text;
  for (const v1::FaceRegion& region : request.face_regions()) {
    absl::StrAppend(&text, " region ", absl::BytesToHexString(region.SerializeAsString()));
  }
  return text;
}

}  // namespace tet
