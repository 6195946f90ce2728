#include "bench/bench_fields.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <utility>
#include <vector>

#include "core/base/parallel.h"
#include "core/field/find_bricks.h"
#include "core/triangle_files/surface_file.h"
#include "core/vdb/openvdb/surface_to_volume.h"
#include "core/volume/volume_builder.h"

namespace tet::bench {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kBand = 3;  // voxels
/// No field below changes by more than this from one voxel to the next.
constexpr float kSteepest = 1.2F;
/// Where a brick's middle is farther than this from the surface, the whole brick is constant.
constexpr float kBrickReach = kBand + kSteepest * 3.5F * std::numbers::sqrt3_v<float>;

struct Ball {
  float radius;

  float extent() const { return radius; }
  float operator()(float x, float y, float z) const {
    return std::sqrt(x * x + y * y + z * z) - radius;
  }
};

struct Torus {
  float tube;

  float ring() const { return 2 * tube; }
  float extent() const { return ring() + tube; }
  float operator()(float x, float y, float z) const {
    const float from_ring = std::sqrt(x * x + y * y) - ring();
    return std::sqrt(from_ring * from_ring + z * z) - tube;
  }
};

/// One of the two halves into which a gyroid divides a ball.
struct Gyroid {
  Ball ball;

  float extent() const { return ball.extent(); }
  float operator()(float x, float y, float z) const {
    constexpr float kPeriod = 24;  // voxels
    constexpr float kWave = 2 * kPi / kPeriod;
    const float u = kWave * x, v = kWave * y, w = kWave * z;
    const float sheet =
        std::sin(u) * std::cos(v) + std::sin(v) * std::cos(w) + std::sin(w) * std::cos(u);
    // Where the sheet is zero its slope is between 1.2 and 1.7 waves.
    return std::max(sheet / (1.5F * kWave), ball(x, y, z));
  }
};

template <class T>
T checked(absl::StatusOr<T> value) {
  if (value.ok()) return *std::move(value);
  std::fprintf(stderr, "cannot make a volume: %s\n", value.status().ToString().c_str());
  std::abort();
}

/// Sorts a region's bricks into those with values and those that are constant inside.
template <class Distance>
void classify_region(const Distance& distance,
                     BrickCoord region,
                     Volume& volume,
                     std::vector<ConstantBrick>& inside) {
  const std::size_t inside_before = inside.size();
  constexpr int kLast = Region::kEdgeBricks - 1;
  const BrickBox box{region, {region.x + kLast, region.y + kLast, region.z + kLast}};
  for_each_brick(box, [&](BrickCoord brick) {
    const auto middle = [](int along) { return 8 * static_cast<float>(along) + 3.5F; };
    const float phi = distance(middle(brick.x), middle(brick.y), middle(brick.z));
    if (phi < -kBrickReach) {
      inside.push_back({brick, -kBand});
    } else if (phi < kBrickReach) {
      volume.bricks.push_back(brick);
    }
  });
  if (inside.size() - inside_before == Region{}.constant.size()) {
    inside.resize(inside_before);
    volume.cubes.push_back({{region.x * 8, region.y * 8, region.z * 8}, 128, -kBand});
  }
}

template <class Distance>
void evaluate_brick(const Distance& distance, BrickCoord brick, float* values) {
  const auto at = [](std::int32_t b, int i) { return static_cast<float>(8 * b + i); };
  for (int x = 0; x < 8; ++x) {
    for (int y = 0; y < 8; ++y) {
      for (int z = 0; z < 8; ++z) {
        const float phi = distance(at(brick.x, x), at(brick.y, y), at(brick.z, z));
        *values++ = std::clamp(phi, -kBand, kBand);
      }
    }
  }
}

template <class Distance>
std::shared_ptr<const Volume> narrow_band(const Distance& distance) {
  Volume volume;
  volume.background = kBand;
  std::vector<ConstantBrick> inside;
  const int edge = Region::kEdgeBricks;
  const int regions = static_cast<int>(std::ceil((distance.extent() + kBand) / 128));
  const BrickCoord first{-regions, -regions, -regions},
      last{regions - 1, regions - 1, regions - 1};
  for_each_brick({first, last}, [&](BrickCoord r) {
    classify_region(distance, {r.x * edge, r.y * edge, r.z * edge}, volume, inside);
  });
  std::sort(volume.bricks.begin(), volume.bricks.end());
  volume.values.resize(volume.bricks.size() * kBrickCells);
  for_each_index(volume.bricks.size(), [&](std::size_t i) {
    evaluate_brick(distance, volume.bricks[i], &volume.values[i * kBrickCells]);
  });
  return std::make_shared<const Volume>(
      checked(index_volume(std::move(volume), std::move(inside))));
}

Ball ball_of_volume(float voxels) { return {std::cbrt(voxels * 3 / (4 * kPi))}; }

}  // namespace

const char* name_of(Solid solid) {
  switch (solid) {
    case Solid::kBall:
      return "ball";
    case Solid::kTorus:
      return "torus";
    case Solid::kGyroid:
      return "gyroid";
  }
  return "unknown";
}

std::shared_ptr<const Volume> make_solid(Solid solid, const BenchSize& size) {
  const auto voxels = static_cast<float>(size.uniform_tets / 12);  // a cell has 12 tets
  switch (solid) {
    case Solid::kBall:
      return narrow_band(ball_of_volume(voxels));
    case Solid::kTorus:
      return narrow_band(Torus{std::cbrt(voxels / (4 * kPi * kPi))});
    case Solid::kGyroid:
      return narrow_band(Gyroid{ball_of_volume(2 * voxels)});
  }
  return nullptr;
}

std::shared_ptr<const Volume> make_bunny(double voxel_size) {
  const absl::StatusOr<TriangleSurface> surface =
      read_surface("/usr/share/glmark2/models/bunny.obj");
  if (absl::IsNotFound(surface.status())) return nullptr;
  return std::make_shared<const Volume>(
      checked(surface_to_volume(checked(surface), voxel_size)).volume);
}

}  // namespace tet::bench
