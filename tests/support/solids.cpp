#include "tests/support/solids.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "tests/support/sanitized.h"
#include "tests/support/volume_fixtures.h"

namespace tet::test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr float kBand = 3;

/// Off the lattice, so that no symmetry hides a wrong tie-break.
constexpr WorldPoint kCentre{0.31, -0.17, 0.43};

double distance(const VoxelCoord& v, const WorldPoint& centre) {
  return std::hypot(v.x - centre.x, v.y - centre.y, v.z - centre.z);
}

VoxelBox cube(int half) { return {{-half, -half, -half}, {half, half, half}}; }

double ball_volume(double r) { return 4.0 / 3 * kPi * r * r * r; }

Solid torus(double major, double minor) {
  const auto phi = [=](VoxelCoord v) {
    const double ring = std::hypot(v.x - kCentre.x, v.y - kCentre.y) - major;
    return static_cast<float>(std::hypot(ring, v.z - kCentre.z) - minor);
  };
  const int half = static_cast<int>(major + minor) + 6;
  return {"torus", narrow_band_volume(cube(half), kBand, phi), 1, 0,
          2 * kPi * kPi * major * minor * minor};
}

Solid two_balls(double radius) {
  const WorldPoint other{kCentre.x + 2 * radius + 9, kCentre.y + 3, kCentre.z};
  const auto phi = [=](VoxelCoord v) {
    return static_cast<float>(std::min(distance(v, kCentre), distance(v, other)) - radius);
  };
  VoxelBox box = cube(static_cast<int>(radius) + 6);
  box.max.x += static_cast<int>(2 * radius) + 12;
  box.max.y += 4;
  return {"two balls", narrow_band_volume(box, kBand, phi), 2, 4, 2 * ball_volume(radius)};
}

Solid ball_with_cavity(double radius, double cavity) {
  const auto phi = [=](VoxelCoord v) {
    const double r = distance(v, kCentre);
    return static_cast<float>(std::max(r - radius, cavity - r));
  };
  return {"ball with a cavity",
          narrow_band_volume(cube(static_cast<int>(radius) + 6), kBand, phi), 2, 4,
          ball_volume(radius) - ball_volume(cavity)};
}

}  // namespace

Volume ball(double radius, const VoxelTransform& transform) {
  const auto scale = static_cast<float>(transform.voxel_size);
  return narrow_band_volume(
      cube(static_cast<int>(radius) + 6), kBand * scale,
      [=](VoxelCoord v) { return scale * static_cast<float>(distance(v, kCentre) - radius); },
      transform);
}

std::vector<Solid> smooth_solids() {
  std::vector<Solid> solids;
  solids.push_back({"ball", ball(17.3), 1, 2, ball_volume(17.3)});
  solids.push_back(torus(19, 7.5));
  solids.push_back(two_balls(10.4));
  solids.push_back(ball_with_cavity(19.2, 6.1));
  return few_of(std::move(solids), 2);
}

Volume plate(const Plate& plate, const VoxelTransform& transform) {
  const auto scale = static_cast<float>(transform.voxel_size);
  const double nx = plate.normal.x, ny = plate.normal.y, nz = plate.normal.z;
  const double length = std::hypot(nx, ny, nz);
  const auto phi = [=](VoxelCoord v) {
    const double height =
        ((v.x - kCentre.x) * nx + (v.y - kCentre.y) * ny + (v.z - kCentre.z) * nz) / length;
    const double r = distance(v, kCentre);
    const double along = std::sqrt(std::max(0.0, r * r - height * height));
    const double from_disc = std::hypot(std::max(0.0, along - plate.radius), height);
    return scale * static_cast<float>(from_disc - plate.thickness / 2);
  };
  return narrow_band_volume(cube(static_cast<int>(plate.radius + plate.thickness) + 6),
                            kBand * scale, phi, transform);
}

Volume ball_with_gap(double radius, double gap) {
  return narrow_band_volume(cube(static_cast<int>(radius) + 6), kBand, [=](VoxelCoord v) {
    const double r = distance(v, kCentre);
    return static_cast<float>(std::max(r - radius, gap / 2 - std::abs(r - radius / 2)));
  });
}

Volume tilted_cube(double edge) {
  // Rows of a rotation.
  constexpr std::array<std::array<double, 3>, 3> kAxes{
      {{0.36, 0.48, 0.8}, {-0.8, 0.6, 0}, {-0.48, -0.64, 0.6}}};
  return narrow_band_volume(cube(static_cast<int>(edge) + 6), kBand, [=](VoxelCoord v) {
    double phi = -edge;
    for (const auto& a : kAxes) {
      const double along =
          a[0] * (v.x - kCentre.x) + a[1] * (v.y - kCentre.y) + a[2] * (v.z - kCentre.z);
      phi = std::max(phi, std::abs(along) - edge / 2);
    }
    return static_cast<float>(phi);
  });
}

Volume gyroid_ball(int edge) {
  const double half = edge / 2.0;
  const double wave = 2 * kPi / 24;
  return narrow_band_volume(cube(static_cast<int>(half) + 4), kBand, [=](VoxelCoord v) {
    const double x = wave * v.x, y = wave * v.y, z = wave * v.z;
    const double sheet =
        std::sin(x) * std::cos(y) + std::sin(y) * std::cos(z) + std::sin(z) * std::cos(x);
    // Close to a distance: the gyroid's gradient is about 1.5 waves long on its surface.
    return static_cast<float>(std::max(sheet / (1.5 * wave), distance(v, kCentre) - half));
  });
}

Volume random_signs(int edge, std::uint32_t seed, int zero_every) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> value(-1, 1);
  return dense_volume({{0, 0, 0}, {edge - 1, edge - 1, edge - 1}}, 1, [&](VoxelCoord) {
    const float phi = value(random);
    return zero_every > 0 && random() % static_cast<unsigned>(zero_every) == 0 ? 0 : phi;
  });
}

Volume ball_with_flipped_tiles(double radius) {
  Volume volume = ball(radius);
  std::mt19937 random(7);
  for (Region& region : volume.regions) {
    for (std::size_t i = 0; i < region.constant.size(); ++i) {
      const bool inside = region.brick_index[i] == Region::kConstant && region.constant[i] < 0;
      if (inside && random() % 3 == 0) region.constant[i] = volume.background;
    }
  }
  return volume;
}

Volume fog_ball(double radius) {
  Volume volume = dense_volume(cube(static_cast<int>(radius) + 8), 0, [=](VoxelCoord v) {
    return static_cast<float>(std::clamp(0.5 + (radius - distance(v, kCentre)) / 4, 0.0, 1.0));
  });
  volume.kind = VolumeKind::kFogVolume;
  return volume;
}

}  // namespace tet::test
