#include "core/volume/inside.h"

#include <algorithm>
#include <string_view>

#include <absl/strings/escaping.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

namespace tet {
namespace {

/// What filters and lossy compression leave behind of a density, as a share of its largest
/// value: far more than their errors, far less than the depth of any level set.
constexpr float kNegligible = 1e-3F;

void widen(ValueRange& range, float value) noexcept {
  range = {std::min(range.min, value), std::max(range.max, value)};
}

std::string range_text(const Volume& volume) {
  const auto [min, max] = value_range(volume);
  return absl::StrFormat("its values are from %g to %g and its background is %g", min, max,
                         volume.background);
}

bool is_inside(float value, InsideSide side, double iso) noexcept {
  return side == InsideSide::kAbove ? value > static_cast<float>(iso)
                                    : value < static_cast<float>(iso);
}

constexpr char kRemedy[] = "say whether it is above or below the iso value (--inside)";

}  // namespace

KindOfValues kind_of_values(ValueRange range, float background) noexcept {
  constexpr KindOfValues kLevelSet{VolumeKind::kLevelSet, KindSource::kValues};
  constexpr KindOfValues kDensity{VolumeKind::kFogVolume, KindSource::kValues};
  constexpr KindOfValues kUnclear{VolumeKind::kLevelSet, KindSource::kNobody};
  if (background < 0) return kUnclear;
  if (range.min >= 0) return kDensity;
  const bool is_noise = -range.min <= kNegligible * range.max;
  if (background > 0) return is_noise ? kUnclear : kLevelSet;
  if (is_noise) return kDensity;
  return range.max <= 0 ? kLevelSet : kUnclear;
}

ValueRange value_range(const Volume& volume) noexcept {
  ValueRange all{volume.background, volume.background};
  for (const ValueRange& range : volume.ranges) {
    widen(all, range.min);
    widen(all, range.max);
  }
  for (const ConstantCube& cube : volume.cubes) widen(all, cube.value);
  for (const Region& region : volume.regions) {
    for (std::size_t i = 0; i < region.constant.size(); ++i) {
      if (region.brick_index[i] == Region::kConstant) widen(all, region.constant[i]);
    }
  }
  return all;
}

InsideSide own_side(const Volume& volume) noexcept {
  return volume.kind == VolumeKind::kFogVolume ? InsideSide::kAbove : InsideSide::kBelow;
}

double default_iso(const Volume& volume, std::optional<InsideSide> asked) noexcept {
  constexpr double kHalfDense = 0.5;
  const InsideSide side = inside_side(volume, asked);
  if (side == InsideSide::kBelow) return 0;
  return side != own_side(volume) && value_range(volume).min < 0 ? 0 : kHalfDense;
}

absl::Status check_side(const Volume& volume, std::optional<InsideSide> asked) {
  if (asked || volume.kind_source != KindSource::kNobody) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      kInsideField, " must be set: the grid has no class, and ", range_text(volume),
      ", which does not tell a level set from a density; ", kRemedy, ", and at which (--iso)"));
}

absl::Status check_background(const Volume& volume,
                              std::optional<InsideSide> asked,
                              double iso) {
  if (asked || volume.kind_source == KindSource::kMaker) return absl::OkStatus();
  const std::string contradiction = describe_inverted(volume, own_side(volume), iso);
  if (contradiction.empty()) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(kInsideField, " must be set: ", contradiction, "; ", kRemedy));
}

std::string describe_inverted(const Volume& volume, InsideSide inside, double iso) {
  if (!is_inside(volume.background, inside, iso)) return "";
  std::string text =
      absl::StrFormat("the background value %g is inside at iso %g", volume.background, iso);
  if (volume.kind_source == KindSource::kMaker) return text;
  if (volume.kind == VolumeKind::kLevelSet && volume.background < 0) {
    absl::StrAppend(&text, ": the level set is inverted, positive inside and negative outside");
  } else if (volume.kind_source == KindSource::kClass && value_range(volume).min < 0) {
    absl::StrAppend(&text, ": the grid's class is ",
                    volume.kind == VolumeKind::kFogVolume ? "fog volume" : "level set",
                    ", but it looks like the other");
  }
  return text;
}

std::string describe_guess(const Volume& volume, std::optional<InsideSide> asked, double iso) {
  if (asked || volume.kind_source != KindSource::kValues) return "";
  const bool above = own_side(volume) == InsideSide::kAbove;
  return absl::StrFormat(
      "grid '%s' has no class, and %s: taken for a %s, inside %s %g; --inside and --iso say "
      "otherwise",
      absl::Utf8SafeCHexEscape(volume.name), range_text(volume),
      above ? "density" : "level set", side_name(own_side(volume)), iso);
}

const char* side_name(InsideSide side) noexcept {
  return side == InsideSide::kAbove ? "above" : "below";
}

std::optional<InsideSide> parse_side(std::string_view name) noexcept {
  for (const InsideSide side : {InsideSide::kBelow, InsideSide::kAbove}) {
    if (name == side_name(side)) return side;
  }
  return std::nullopt;
}

}  // namespace tet
