#include "core/field/field_difference.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <optional>

#include "core/base/brick_sets.h"
#include "core/base/parallel.h"
#include "core/field/find_bricks.h"
#include "core/field/scene_samples.h"
#include "core/scene/scene.h"
#include "core/volume/volume_reader.h"

namespace tet {
namespace {

bool same_bits(const float* a, const float* b) noexcept {
  // 0 and -0 differ here, and a NaN is itself.
  // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison)
  return std::memcmp(a, b, kBrickCells * sizeof(float)) == 0;
}

bool same_brick(const VolumeReader::Brick& a, const VolumeReader::Brick& b) noexcept {
  if (a.values != nullptr && b.values != nullptr) return same_bits(a.values, b.values);
  return a.values == b.values && a.range.min == b.range.min;
}

bool same_lattice(const Volume& a, const Volume& b) noexcept {
  return a.kind == b.kind && a.background == b.background &&
         a.transform.linear == b.transform.linear &&
         a.transform.translation == b.transform.translation;
}

bool same_cube(const ConstantCube& a, const ConstantCube& b) noexcept {
  return a.min == b.min && a.edge == b.edge && a.value == b.value;
}

/// Cubes that only one of the two has.
std::vector<ConstantCube> unlike_cubes(const Volume& a, const Volume& b) {
  std::vector<ConstantCube> unlike;
  const auto add_unlike = [&](const Volume& of, const Volume& other) {
    for (const ConstantCube& cube : of.cubes) {
      const auto at = std::ranges::lower_bound(other.cubes, cube.min, {}, &ConstantCube::min);
      if (at == other.cubes.end() || !same_cube(*at, cube)) unlike.push_back(cube);
    }
  };
  add_unlike(a, b);
  add_unlike(b, a);
  return unlike;
}

/// The regions in which anything may differ, by their lowest bricks; std::nullopt when they are
/// too many to look at.
std::optional<std::vector<BrickCoord>> regions_to_compare(const Volume& a, const Volume& b) {
  std::vector<BrickCoord> regions;
  for (const Volume* volume : {&a, &b}) {
    for (const Region& region : volume->regions) regions.push_back(region.min);
  }
  for (const ConstantCube& cube : unlike_cubes(a, b)) {
    if (cube.edge != kBrickEdge * Region::kEdgeBricks) return std::nullopt;
    regions.push_back(
        {cube.min.x / kBrickEdge, cube.min.y / kBrickEdge, cube.min.z / kBrickEdge});
  }
  sort_unique(regions);
  return regions;
}

/// Bricks of voxels that differ.
std::vector<BrickCoord> unlike_bricks(const Volume& a,
                                      const Volume& b,
                                      const std::vector<BrickCoord>& regions) {
  std::vector<std::vector<BrickCoord>> of_region(regions.size());
  for_each_range(regions.size(), 1, [&](std::size_t begin, std::size_t end) {
    VolumeReader reader_a(a), reader_b(b);
    for (std::size_t i = begin; i < end; ++i) {
      constexpr std::int32_t kLast = Region::kEdgeBricks - 1;
      const BrickCoord min = regions[i];
      for_each_brick({min, {min.x + kLast, min.y + kLast, min.z + kLast}}, [&](BrickCoord at) {
        if (!same_brick(reader_a.brick(at), reader_b.brick(at))) of_region[i].push_back(at);
      });
    }
  });
  std::vector<BrickCoord> unlike;
  for (const auto& bricks : of_region)
    unlike.insert(unlike.end(), bricks.begin(), bricks.end());
  return unlike;
}

/// Lattice bricks along one axis whose samples may read a voxel of a brick.
struct ReadersAlong {
  std::int32_t first, last;

  ReadersAlong(std::int32_t voxel_brick, double spacing_voxels) {
    // Nodes [-2, 10] of a brick are sampled, from the voxels on either side of each.
    constexpr int kFirstNode = -2, kLastNode = 10;
    const double lowest = static_cast<double>(kBrickEdge) * voxel_brick - 1;
    const double highest = static_cast<double>(kBrickEdge) * (voxel_brick + 1.0);
    first = brick_at(std::ceil((lowest / spacing_voxels - kLastNode) / kBrickEdge));
    last = brick_at(std::floor((highest / spacing_voxels - kFirstNode) / kBrickEdge));
  }
  double count() const { return static_cast<double>(last) - first + 1; }

 private:
  /// No lattice has bricks beyond these.
  static std::int32_t brick_at(double brick) {
    constexpr double kMost = 1 << 30;
    return static_cast<std::int32_t>(std::clamp(brick, -kMost, kMost));
  }
};

/// Lattice bricks whose samples may read a voxel of these bricks; std::nullopt where a spacing
/// far below the voxels makes them too many to list.
std::optional<std::vector<BrickCoord>> readers_of(const std::vector<BrickCoord>& voxel_bricks,
                                                  double spacing_voxels) {
  double count = 0;
  std::vector<BrickCoord> readers;
  for (const BrickCoord b : voxel_bricks) {
    const ReadersAlong x(b.x, spacing_voxels), y(b.y, spacing_voxels), z(b.z, spacing_voxels);
    count += x.count() * y.count() * z.count();
    if (count > FieldDifference::kMostReaders) return std::nullopt;
    for_each_brick({{x.first, y.first, z.first}, {x.last, y.last, z.last}},
                   [&](BrickCoord reader) { readers.push_back(reader); });
  }
  sort_unique(readers);
  return readers;
}

}  // namespace

std::unique_ptr<const FieldDifference> FieldDifference::between(
    const PhiField& earlier, const PhiField& now, const std::vector<BrickCoord>* replaced) {
  const bool scenes = earlier.scene != nullptr;
  if (scenes != (now.scene != nullptr) || earlier.spacing_voxels != now.spacing_voxels) {
    return nullptr;
  }
  std::unique_ptr<FieldDifference> difference(new FieldDifference(earlier, now));
  if (scenes) return difference;
  const Volume &a = *earlier.volume, &b = *now.volume;
  if (earlier.iso != now.iso || earlier.negated() != now.negated() || !same_lattice(a, b)) {
    return nullptr;
  }
  std::optional<std::vector<BrickCoord>> readers;
  if (replaced != nullptr) {
    readers = readers_of(*replaced, now.spacing_voxels);
  } else if (const auto regions = regions_to_compare(a, b)) {
    readers = readers_of(unlike_bricks(a, b, *regions), now.spacing_voxels);
  }
  if (!readers) return nullptr;
  difference->touched_ = *std::move(readers);
  difference->touched_index_ = BrickIndex(difference->touched_);
  return difference;
}

FieldDifference::Asker::Asker(const FieldDifference& difference) : difference_(difference) {
  if (difference.now_.scene == nullptr) return;
  earlier_ = std::make_unique<SceneEvaluator>(*difference.earlier_.scene);
  now_ = std::make_unique<SceneEvaluator>(*difference.now_.scene);
}

bool FieldDifference::Asker::same_around(BrickCoord brick) {
  if (now_ == nullptr) return difference_.touched_index_.find(brick) == kNoBrick;
  focus_on_samples(*earlier_, difference_.now_.spacing_voxels, brick);
  focus_on_samples(*now_, difference_.now_.spacing_voxels, brick);
  return now_->same_in_focus(*earlier_);
}

}  // namespace tet
