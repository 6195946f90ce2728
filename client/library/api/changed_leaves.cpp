#include "client/library/api/changed_leaves.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include <absl/status/status.h>
#include <absl/strings/str_cat.h>

#include "core/base/brick_sets.h"
#include "core/volume/volume_reader.h"

namespace tetstream {
namespace {

static_assert(std::endian::native == std::endian::little);

absl::Status cannot_change(const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat(
      what, " is another than that of the session's volume: begin another session"));
}

bool same_cubes(const tet::Volume& a, const tet::Volume& b) {
  return std::ranges::equal(
      a.cubes, b.cubes, [](const tet::ConstantCube& one, const tet::ConstantCube& other) {
        return one.min == other.min && one.edge == other.edge && one.value == other.value;
      });
}

absl::Status check(const tet::Volume& before, const tet::Volume& after) {
  if (before.kind != after.kind) return cannot_change("the kind");
  if (before.transform != after.transform) return cannot_change("the place of the voxels");
  if (before.background != after.background) return cannot_change("the background");
  if (!same_cubes(before, after)) return cannot_change("what is far from the surface");
  return absl::OkStatus();
}

/// Where one of the volumes knows something, but for what lies in its cubes.
std::vector<tet::BrickCoord> known_regions(const tet::Volume& before,
                                           const tet::Volume& after) {
  std::vector<tet::BrickCoord> corners;
  for (const tet::Volume* const volume : {&before, &after}) {
    for (const tet::Region& region : volume->regions) corners.push_back(region.min);
  }
  tet::sort_unique(corners);
  return corners;
}

std::span<const float> values_of(const tet::VolumeReader::Brick& brick) {
  if (brick.values == nullptr) return {&brick.range.min, 1};
  return {brick.values, tet::kBrickCells};
}

v1::LeafUpdate leaf_of(tet::BrickCoord brick, std::span<const float> values) {
  v1::LeafUpdate leaf;
  leaf.set_x(brick.x * tet::kBrickEdge);
  leaf.set_y(brick.y * tet::kBrickEdge);
  leaf.set_z(brick.z * tet::kBrickEdge);
  leaf.set_values(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  return leaf;
}

/// Two volumes, brick by brick.
class Comparison {
 public:
  Comparison(const tet::Volume& before, const tet::Volume& after)
      : before_(before), after_(after) {}

  bool differ(tet::BrickCoord brick) {
    const tet::VolumeReader::Brick was = before_.brick(brick);
    const tet::VolumeReader::Brick is = after_.brick(brick);
    return !std::ranges::equal(values_of(was), values_of(is));
  }
  v1::LeafUpdate leaf(tet::BrickCoord brick) {
    const tet::VolumeReader::Brick is = after_.brick(brick);
    return leaf_of(brick, values_of(is));
  }

 private:
  tet::VolumeReader before_, after_;
};

/// Those that differ of the bricks of some regions. A wide narrow band has thousands of regions
/// of 4096 bricks each: what is listed are only those that changed.
absl::StatusOr<std::vector<tet::BrickCoord>> changed_bricks(
    Comparison& volumes,
    const std::vector<tet::BrickCoord>& regions,
    const tet::Cancellation& cancellation) {
  constexpr std::int32_t kEdge = tet::Region::kEdgeBricks;
  std::vector<tet::BrickCoord> changed;
  for (const tet::BrickCoord min : regions) {
    if (absl::Status status = check_cancelled(cancellation); !status.ok()) return status;
    for (std::int32_t i = 0; i < kEdge * kEdge * kEdge; ++i) {
      const tet::BrickCoord brick{min.x + i / (kEdge * kEdge), min.y + i / kEdge % kEdge,
                                  min.z + i % kEdge};
      if (volumes.differ(brick)) changed.push_back(brick);
    }
  }
  tet::sort_unique(changed);
  return changed;
}

}  // namespace

absl::StatusOr<std::vector<v1::LeafUpdate>> changed_leaves(
    const tet::Volume& before,
    const tet::Volume& after,
    const tet::Cancellation& cancellation,
    const std::vector<tet::BrickCoord>* among) {
  if (absl::Status status = check(before, after); !status.ok()) return status;
  Comparison volumes(before, after);
  std::vector<v1::LeafUpdate> leaves;
  if (among != nullptr) {
    for (const tet::BrickCoord brick : *among) {
      if (volumes.differ(brick)) leaves.push_back(volumes.leaf(brick));
    }
    return leaves;
  }
  const auto changed = changed_bricks(volumes, known_regions(before, after), cancellation);
  if (!changed.ok()) return changed.status();
  for (const tet::BrickCoord brick : *changed) leaves.push_back(volumes.leaf(brick));
  return leaves;
}

}  // namespace tetstream
