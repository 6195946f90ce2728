#include "client/library/api/changed_leaves.h"

#include <algorithm>
#include <bit>
#include <cstddef>
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

/// Bricks of which one of the volumes knows something, but for what lies in its cubes.
std::vector<tet::BrickCoord> known_bricks(const tet::Volume& before, const tet::Volume& after) {
  std::vector<tet::BrickCoord> bricks;
  for (const tet::Volume* const volume : {&before, &after}) {
    for (const tet::Region& region : volume->regions) {
      for (std::int32_t i = 0; i < 4096; ++i) {
        bricks.push_back(
            {region.min.x + i / 256, region.min.y + i / 16 % 16, region.min.z + i % 16});
      }
    }
  }
  tet::sort_unique(bricks);
  return bricks;
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

}  // namespace

absl::StatusOr<std::vector<v1::LeafUpdate>> changed_leaves(
    const tet::Volume& before,
    const tet::Volume& after,
    const std::vector<tet::BrickCoord>* among) {
  if (absl::Status status = check(before, after); !status.ok()) return status;
  tet::VolumeReader reads_before(before), reads_after(after);
  std::vector<v1::LeafUpdate> leaves;
  for (const tet::BrickCoord brick : among ? *among : known_bricks(before, after)) {
    const tet::VolumeReader::Brick was = reads_before.brick(brick);
    const tet::VolumeReader::Brick is = reads_after.brick(brick);
    if (!std::ranges::equal(values_of(was), values_of(is))) {
      leaves.push_back(leaf_of(brick, values_of(is)));
    }
  }
  return leaves;
}

}  // namespace tetstream
