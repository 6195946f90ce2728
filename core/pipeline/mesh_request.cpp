#include "core/pipeline/mesh_request.h"

#include <array>
#include <cmath>
#include <utility>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

namespace tet {
namespace {

constexpr std::array<std::pair<Preset, std::string_view>, 3> kPresetNames{
    {
     {Preset::kDefault, "default"},
     {Preset::kMinAngle, "min-angle"},
     {Preset::kBothSides, "both-sides"},
     }
};

constexpr double kFogIso = 0.5;

}  // namespace

std::optional<Preset> parse_preset(std::string_view name) {
  for (const auto& [preset, known] : kPresetNames) {
    if (known == name) return preset;
  }
  return std::nullopt;
}

std::string_view preset_name(Preset preset) {
  for (const auto& [known, name] : kPresetNames) {
    if (known == preset) return name;
  }
  return "unknown";
}

StuffingRules stuffing_rules(Preset preset) {
  switch (preset) {
    case Preset::kDefault:
      return {
          .limits = {0.25F, 0.35F}
      };
    case Preset::kMinAngle:
      return {
          .limits = {0.2675F, 0.3896F}
      };
    case Preset::kBothSides:
      return {
          .limits = {0.20F, 0.30F},
            .both_sides = true
      };
  }
  return {};
}

AngleBounds angle_bounds(Preset preset, CoordinateType coordinates) {
  const bool rounded = coordinates == CoordinateType::kFloat32;
  switch (preset) {
    case Preset::kDefault:
      return rounded ? AngleBounds{11.2, 154.9} : AngleBounds{11.3, 154.7};
    case Preset::kMinAngle:
      return rounded ? AngleBounds{11.7, 161.3} : AngleBounds{11.8, 161.2};
    case Preset::kBothSides:
      return rounded ? AngleBounds{9.3, 157.6} : AngleBounds{9.4, 157.4};
  }
  return {};
}

absl::StatusOr<CanonicalRequest> canonical(const MeshRequest& request, const Volume& volume) {
  CanonicalRequest out;
  out.spacing = request.spacing.value_or(volume.transform.voxel_size);
  if (!(out.spacing > 0) || !std::isfinite(out.spacing)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("spacing %g is not a positive number", out.spacing));
  }
  const double default_iso = volume.kind == VolumeKind::kFogVolume ? kFogIso : 0;
  out.iso = request.iso.value_or(default_iso);
  if (!std::isfinite(static_cast<float>(out.iso))) {
    return absl::InvalidArgumentError(absl::StrFormat("iso %g is not a finite float", out.iso));
  }
  out.levels = request.levels;
  if (out.levels < 0 || out.levels > kMaxLevels) {
    return absl::InvalidArgumentError(
        absl::StrFormat("levels %d is outside 0..%d", out.levels, kMaxLevels));
  }
  out.preset = request.preset;
  if (request.box && !stuffing_rules(request.preset).both_sides) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "a box is for the preset both-sides; with %s the mesh ends where the inside does",
        preset_name(request.preset)));
  }
  return out;
}

}  // namespace tet
