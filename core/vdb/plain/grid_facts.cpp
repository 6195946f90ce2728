#include "core/vdb/plain/grid_facts.h"

#include <algorithm>
#include <array>

#include <absl/strings/ascii.h>
#include <absl/strings/str_format.h>

#include "core/vdb/plain/conversion_report.h"
#include "core/volume/check_transform.h"
#include "core/volume/inside.h"

namespace tet {
namespace {

constexpr std::string_view kLevelSet = "level set";
constexpr std::string_view kFogVolume = "fog volume";
constexpr std::string_view kStaggered = "staggered";

}  // namespace

std::string grid_class_of(std::string_view stored) {
  const std::string text = absl::AsciiStrToLower(
      absl::StripAsciiWhitespace(absl::string_view(stored.data(), stored.size())));
  for (const std::string_view known : {kLevelSet, kFogVolume, kStaggered}) {
    if (text == known) return text;
  }
  return "unknown";
}

std::string describe_voxels(const VoxelTransform& transform) {
  if (has_cubic_voxels(transform)) return "";
  const auto [x, y, z] = voxel_edges(transform);
  return absl::StrFormat("voxels of %g x %g x %g%s, meshed on a cubic lattice", x, y, z,
                         are_square(transform) ? "" : ", sheared");
}

std::string surface_text(std::span<const std::pair<std::string, std::string>> metadata) {
  constexpr std::size_t kMostBytes = 1000;
  std::string text;
  for (const auto& [name, value] : metadata) {
    if (name != kSurfaceMetadata) text += text.empty() ? "warning: " : "; warning: ";
    text += value;
  }
  text.resize(std::min(text.size(), kMostBytes));
  std::replace_if(
      text.begin(), text.end(),
      [](char c) { return !absl::ascii_isprint(static_cast<unsigned char>(c)); }, '?');
  return text;
}

absl::StatusOr<Volume> finish_volume(Volume volume, std::vector<ConstantBrick> constants) {
  if (has_inside(volume.kind) && volume.bricks.empty() && volume.cubes.empty() &&
      constants.empty()) {
    return absl::FailedPreconditionError(
        "it is empty: every voxel has the background value; check what wrote it");
  }
  return index_volume(std::move(volume), std::move(constants));
}

void set_kind(std::string_view grid_class, Volume& volume) {
  const auto kind = [&]() -> KindOfValues {
    if (grid_class == kLevelSet) return {VolumeKind::kLevelSet, KindSource::kClass};
    if (grid_class == kFogVolume) return {VolumeKind::kFogVolume, KindSource::kClass};
    return kind_of_values(value_range(volume), volume.background);
  }();
  volume.kind = kind.kind;
  volume.kind_source = kind.source;
}

}  // namespace tet
