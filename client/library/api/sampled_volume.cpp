#include "client/library/api/sampled_volume.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <absl/status/status.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/volume/check_transform.h"
#include "core/volume/volume_builder.h"

namespace tetstream {
namespace {

constexpr std::size_t kEdge = tet::kBrickEdge;
constexpr float kBackgroundSpacings = 3;

tet::VolumeKind to_core(VolumeKind kind) {
  switch (kind) {
    case VolumeKind::kLevelSet:
      return tet::VolumeKind::kLevelSet;
    case VolumeKind::kDensity:
      return tet::VolumeKind::kFogVolume;
    case VolumeKind::kValues:
      return tet::VolumeKind::kField;
  }
  return tet::VolumeKind::kLevelSet;
}

float background_of(const SampleArray& samples) {
  if (samples.background) return *samples.background;
  if (samples.kind != VolumeKind::kLevelSet) return 0;
  return kBackgroundSpacings * static_cast<float>(samples.spacing);
}

absl::Status check(const SampleArray& samples) {
  const auto [x, y, z] = samples.size;
  const auto most = static_cast<std::size_t>(tet::kMaxVoxelCoord);
  if (x == 0 || y == 0 || z == 0 || std::max({x, y, z}) > most) {
    return absl::InvalidArgumentError(
        absl::StrFormat("size %d x %d x %d: each must be 1 to %d", x, y, z, most));
  }
  if (samples.values.size() / x / y != z || samples.values.size() % (x * y) != 0) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "size %d x %d x %d does not agree with %d values", x, y, z, samples.values.size()));
  }
  if (!(samples.spacing > 0) || !std::isfinite(samples.spacing)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("spacing %g is not positive", samples.spacing));
  }
  if (absl::Status s = tet::check_edge("spacing", samples.spacing); !s.ok()) return s;
  for (const double coordinate : samples.origin) {
    if (std::isfinite(coordinate)) continue;
    return absl::InvalidArgumentError(absl::StrFormat("origin %g is not finite", coordinate));
  }
  return absl::OkStatus();
}

tet::VoxelTransform transform_of(const SampleArray& samples) {
  tet::VoxelTransform transform;
  for (std::size_t i = 0; i < 3; ++i) transform.linear[i][i] = samples.spacing;
  transform.translation = samples.origin;
  transform.voxel_size = samples.spacing;
  return transform;
}

using Brick = std::array<float, tet::kBrickCells>;

/// The samples from `begin` on; the background where the array ends within the brick.
Brick brick_of(const SampleArray& samples,
               const std::array<std::size_t, 3>& begin,
               float background) {
  Brick brick;
  brick.fill(background);
  std::array<std::size_t, 3> end{};
  for (std::size_t i = 0; i < 3; ++i) end[i] = std::min(begin[i] + kEdge, samples.size[i]);
  for (std::size_t x = begin[0]; x < end[0]; ++x) {
    for (std::size_t y = begin[1]; y < end[1]; ++y) {
      const std::size_t row = (x * samples.size[1] + y) * samples.size[2];
      const auto from = samples.values.begin() + static_cast<std::ptrdiff_t>(row + begin[2]);
      const std::size_t to = ((x - begin[0]) * kEdge + (y - begin[1])) * kEdge;
      std::copy_n(from, end[2] - begin[2], brick.begin() + static_cast<std::ptrdiff_t>(to));
    }
  }
  return brick;
}

void add(const Brick& brick, tet::BrickCoord place, tet::VolumeBuilder& builder) {
  const bool constant =
      std::all_of(brick.begin(), brick.end(), [&](float value) { return value == brick[0]; });
  if (constant) {
    builder.add_constant_brick(place, brick[0]);
  } else {
    builder.add_brick(place, brick);
  }
}

tet::BrickCoord brick_at(const std::array<std::size_t, 3>& voxel) {
  const auto coordinate = [&](std::size_t i) {
    return static_cast<std::int32_t>(voxel[i] / kEdge);
  };
  return {coordinate(0), coordinate(1), coordinate(2)};
}

}  // namespace

absl::StatusOr<tet::Volume> volume_of_samples(const SampleArray& samples) {
  if (absl::Status status = check(samples); !status.ok()) return status;
  const float background = background_of(samples);
  tet::VolumeBuilder builder(to_core(samples.kind), background, transform_of(samples));
  std::array<std::size_t, 3> begin{};
  for (begin[0] = 0; begin[0] < samples.size[0]; begin[0] += kEdge) {
    for (begin[1] = 0; begin[1] < samples.size[1]; begin[1] += kEdge) {
      for (begin[2] = 0; begin[2] < samples.size[2]; begin[2] += kEdge) {
        add(brick_of(samples, begin, background), brick_at(begin), builder);
      }
    }
  }
  absl::StatusOr<tet::Volume> volume = std::move(builder).build();
  if (volume.ok()) volume->name = "samples";
  return volume;
}

}  // namespace tetstream
