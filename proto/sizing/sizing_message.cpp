#include "proto/sizing/sizing_message.h"

#include <array>
#include <cstddef>
#include <utility>
#include <variant>

#include <absl/strings/str_cat.h>

#include "proto/scene/message_parts.h"

namespace tet {
namespace {

namespace v1 = ::tetstream::v1;

/// Reads one region; the first list of the wrong length stays as the complaint.
class RegionReader {
 public:
  explicit RegionReader(const v1::SizingRegion& region) : region_(region) {}

  SizingRegion region() { return {region_.size(), shape()}; }
  /// Empty if nothing was wrong.
  const std::string& complaint() const { return complaint_; }

 private:
  decltype(SizingRegion::shape) shape() {
    switch (region_.shape_case()) {
      case v1::SizingRegion::kBox:
        return WorldBox{point("box.min", region_.box().min()),
                        point("box.max", region_.box().max())};
      case v1::SizingRegion::kBall:
        return BallRegion{point("ball.centre", region_.ball().centre()),
                          region_.ball().radius()};
      case v1::SizingRegion::kCapsule:
        return CapsuleRegion{point("capsule.start", region_.capsule().start()),
                             point("capsule.end", region_.capsule().end()),
                             region_.capsule().radius()};
      case v1::SizingRegion::kShell:
        return ShellRegion{region_.shell().depth()};
      default:
        return std::monostate{};
    }
  }

  template <class Field>
  WorldPoint point(const char* field, const Field& given) {
    std::array<double, 3> at{};
    if (std::string wrong = read_three(field, given, at); complaint_.empty()) {
      complaint_ = std::move(wrong);
    }
    return {at[0], at[1], at[2]};
  }

  const v1::SizingRegion& region_;
  std::string complaint_;
};

template <class Field>
void write(const WorldPoint& point, Field& field) {
  for (const double at : {point.x, point.y, point.z}) field.Add(at);
}

void write(const std::monostate&, v1::SizingRegion&) {}
void write(const WorldBox& box, v1::SizingRegion& message) {
  write(box.min, *message.mutable_box()->mutable_min());
  write(box.max, *message.mutable_box()->mutable_max());
}
void write(const BallRegion& ball, v1::SizingRegion& message) {
  write(ball.centre, *message.mutable_ball()->mutable_centre());
  message.mutable_ball()->set_radius(ball.radius);
}
void write(const CapsuleRegion& capsule, v1::SizingRegion& message) {
  write(capsule.start, *message.mutable_capsule()->mutable_start());
  write(capsule.end, *message.mutable_capsule()->mutable_end());
  message.mutable_capsule()->set_radius(capsule.radius);
}
void write(const ShellRegion& shell, v1::SizingRegion& message) {
  message.mutable_shell()->set_depth(shell.depth);
}

}  // namespace

absl::StatusOr<Sizing> sizing_of_message(const v1::Sizing& message) {
  Sizing sizing;
  if (message.has_coarsest()) sizing.coarsest = message.coarsest();
  if (message.has_growth()) sizing.growth = message.growth();
  for (int i = 0; i < message.regions_size(); ++i) {
    RegionReader reader(message.regions(i));
    sizing.regions.push_back(reader.region());
    if (reader.complaint().empty()) continue;
    return absl::InvalidArgumentError(absl::StrCat("regions[", i, "].", reader.complaint()));
  }
  if (message.has_grid()) {
    sizing.grid = SizingGrid{message.grid().name(), message.grid().grid_name()};
  }
  sizing.grade_surface = message.grade_surface();
  if (message.has_chord_error()) sizing.chord_error = message.chord_error();
  sizing.leaves_across = message.leaves_across();
  if (auto status = check_sizing(sizing); !status.ok()) return status;
  return sizing;
}

v1::Sizing message_of_sizing(const Sizing& sizing) {
  v1::Sizing message;
  if (sizing.coarsest) message.set_coarsest(*sizing.coarsest);
  message.set_growth(sizing.growth);
  for (const SizingRegion& region : sizing.regions) {
    v1::SizingRegion& out = *message.add_regions();
    out.set_size(region.size);
    std::visit([&](const auto& shape) { write(shape, out); }, region.shape);
  }
  if (sizing.grid) {
    message.mutable_grid()->set_name(sizing.grid->file);
    message.mutable_grid()->set_grid_name(sizing.grid->name);
  }
  message.set_grade_surface(sizing.grade_surface);
  if (sizing.chord_error) message.set_chord_error(*sizing.chord_error);
  message.set_leaves_across(sizing.leaves_across);
  return message;
}

absl::StatusOr<v1::Sizing> sizing_from_json(const std::string& json) {
  return message_from_json<v1::Sizing>(json, "sizing");
}

}  // namespace tet
