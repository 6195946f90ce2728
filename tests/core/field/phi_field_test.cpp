#include "core/field/phi_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/field/brick_sides.h"
#include "core/volume/interpolate_lattice.h"
#include "tests/support/solids.h"
#include "tests/support/volume_fixtures.h"

namespace tet {
namespace {

std::unique_ptr<BrickSamples> samples_of(const Volume& volume,
                                         double spacing_voxels,
                                         BrickCoord brick,
                                         float iso = 0) {
  PhiField field;
  field.volume = &volume;
  field.iso = iso;
  field.spacing_voxels = spacing_voxels;
  auto samples = std::make_unique<BrickSamples>();
  PhiSampler(field).sample(brick, *samples);
  return samples;
}

/// Calls `visit(x, y, z)` for all of [min, max]^3.
template <class Visit>
void for_each_in_cube(int min, int max, const Visit& visit) {
  for (int x = min; x <= max; ++x) {
    for (int y = min; y <= max; ++y) {
      for (int z = min; z <= max; ++z) visit(x, y, z);
    }
  }
}

TEST(PhiSampler, FindsTheTrilinearValuesAtEverySpacing) {
  const Volume random = test::random_signs(40, 31, 5);
  for (const double spacing : {0.4, 1.0, 1.5, 2.0, 3.7, 9.1}) {
    PhiField field;
    field.volume = &random;
    field.spacing_voxels = spacing;
    PhiSampler sampler(field);
    const auto samples = samples_of(random, spacing, {0, 0, 0});
    float worst = 0;
    const auto compare = [&](float sample, double x, double y, double z) {
      worst = std::max(worst, std::abs(sample - sampler.at(x, y, z)));
    };
    for_each_in_cube(-2, 9, [&](int x, int y, int z) {
      const auto i = static_cast<std::size_t>(halo_index(x, y, z));
      compare(samples->corner[i], x, y, z);
      compare(samples->centre[i], x + 0.5, y + 0.5, z + 0.5);
    });
    EXPECT_LT(worst, 1e-6) << "of values up to 1, at spacing " << spacing;
  }
}

/// All of `voxels` are -1 but for those at the coordinate `x`, which are `value`.
Volume wall_of(std::int32_t x, float value) {
  return test::dense_volume({{0, 0, 0}, {31, 31, 31}}, -1,
                            [=](VoxelCoord v) { return v.x == x ? value : -1.0F; });
}

TEST(PhiSampler, TellsTheSideOfACornerAsItsSampleDoesThoughItLieOnTheSurface) {
  int on_either_side[2] = {0, 0};
  for (const double spacing : {1.1125, 1.05625, 0.9125, 1.3}) {
    const std::int64_t corner = 8;
    const double at = spacing * static_cast<double>(corner), voxel = std::floor(at);
    const auto exact = static_cast<float>((1 - (at - voxel)) / (at - voxel));
    float value = exact;
    for (int step = 0; step < 8; ++step) value = std::nextafter(value, 0.0F);
    for (int step = 0; step < 16; ++step, value = std::nextafter(value, 2 * exact)) {
      const Volume wall = wall_of(static_cast<std::int32_t>(voxel) + 1, value);
      PhiField field;
      field.volume = &wall;
      field.spacing_voxels = spacing;
      const auto samples = samples_of(wall, spacing, {1, 1, 1});
      const float sample = samples->corner[static_cast<std::size_t>(halo_index(0, 0, 0))];
      EXPECT_EQ(PhiSampler(field).inside(corner, 8, 8), sample < 0)
          << "at spacing " << spacing << " with " << value << " beside it";
      ++on_either_side[sample < 0 ? 1 : 0];
    }
  }
  EXPECT_GT(on_either_side[0], 0);
  EXPECT_GT(on_either_side[1], 0);
}

TEST(PhiSampler, FindsTheSameBitsInEveryBrickThatSeesANode) {
  const Volume random = test::random_signs(64, 32, 7);
  for (const double spacing : {0.7, 1.0, 1.5, 2.3}) {
    const BrickCoord home{1, 1, 0};
    const auto here = samples_of(random, spacing, home);
    for_each_in_cube(-1, 1, [&](int bx, int by, int bz) {
      const auto there = samples_of(random, spacing, {home.x + bx, home.y + by, home.z + bz});
      bool same = true;
      const auto compare = [&](const auto& ours, const auto& theirs, int max) {
        for_each_in_cube(-2, max, [&](int x, int y, int z) {
          const std::array<int, 3> at{x - 8 * bx, y - 8 * by, z - 8 * bz};
          if (std::ranges::any_of(at, [&](int v) { return v < -2 || v > max; })) return;
          same = same && ours[static_cast<std::size_t>(halo_index(x, y, z))] ==
                             theirs[static_cast<std::size_t>(halo_index(at[0], at[1], at[2]))];
        });
      };
      compare(here->corner, there->corner, 10);
      compare(here->centre, there->centre, 9);
      EXPECT_TRUE(same) << "from " << bx << " " << by << " " << bz << " at " << spacing;
    });
  }
}

TEST(PhiSampler, NeverLeavesTheRangeOfTheVoxelsAroundANode) {
  const Volume random = test::random_signs(32, 33);
  VolumeReader reader(random);
  const double spacing = 1.3;
  const auto samples = samples_of(random, spacing, {1, 0, 0});
  for_each_in_cube(-2, 10, [&](int x, int y, int z) {
    const auto below = [&](int at) { return static_cast<int>(std::floor(spacing * at)); };
    const auto cell = reader.cell({below(8 + x), below(y), below(z)});
    const float phi = samples->corner[static_cast<std::size_t>(halo_index(x, y, z))];
    const auto [least, most] = std::ranges::minmax(cell);
    EXPECT_TRUE(phi >= least - 1e-6F && phi <= most + 1e-6F);
    EXPECT_TRUE(least <= 0 || phi > 0);
    EXPECT_TRUE(most >= 0 || phi < 0);
  });
}

TEST(PhiSampler, SamplesPointsTogetherAsItSamplesEach) {
  const Volume volume = test::random_signs(64, 33, 7);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> beyond(-2.5, 10.5);
  // At wider spacings there are too many voxels around a brick to copy them.
  for (const double spacing : {0.3, 0.9, 1.0, 1.15, 1.7, 3.3}) {
    PhiField field;
    field.volume = &volume;
    field.spacing_voxels = spacing;
    PhiSampler together(field), each(field);
    for (const BrickCoord brick : {BrickCoord{0, 0, 0}, BrickCoord{1, -1, 2}}) {
      PhiSampler::Points points;
      for (int i = 0; i < 100; ++i) {
        const auto within = [&](std::int32_t at) {  // the halo, its ends with it
          return 8.0 * at + std::clamp(beyond(random), -2.0, 10.0);
        };
        for (std::size_t k = 0; k < PhiSampler::kPoints; ++k) {
          points.x[k] = within(brick.x);
          points.y[k] = within(brick.y);
          points.z[k] = within(brick.z);
        }
        together.sample_points(brick, points);
        for (std::size_t k = 0; k < PhiSampler::kPoints; ++k) {
          ASSERT_EQ(points.phi[k], each.at(points.x[k], points.y[k], points.z[k])) << spacing;
        }
      }
    }
  }
}

TEST(PhiSampler, TurnsDensitiesRound) {
  const Volume fog = test::fog_ball(9);
  for (const double spacing : {1.0, 1.5}) {
    const auto samples = samples_of(fog, spacing, {0, 0, 0}, 0.5F);
    EXPECT_LT(samples->corner[static_cast<std::size_t>(halo_index(0, 0, 0))], 0);
    EXPECT_GT(samples->corner[static_cast<std::size_t>(halo_index(10, 10, 10))], 0);
  }
}

/// Whether all valid samples are inside, or none is.
bool lie_on_one_side(const BrickSamples& samples) {
  int inside = 0, outside = 0;
  const auto add = [&](const auto& column, int max) {
    for_each_in_cube(-2, max, [&](int x, int y, int z) {
      ++(column[static_cast<std::size_t>(halo_index(x, y, z))] < 0 ? inside : outside);
    });
  };
  add(samples.corner, 10);
  add(samples.centre, 9);
  return inside == 0 || outside == 0;
}

/// The smallest floats, inside and outside, and zeros.
Volume tiny_values() {
  return test::dense_volume({{-20, -20, -20}, {20, 20, 20}}, 3, [](VoxelCoord v) {
    constexpr float kTiny = std::numeric_limits<float>::denorm_min();
    return v.x + v.y * v.z < 17 ? -kTiny : (v.z > 3 ? 0 : kTiny);
  });
}

TEST(PhiSampler, TellsOfABrickWithoutSamplingItThatItsSamplesLieOnOneSide) {
  std::vector<std::pair<Volume, float>> fields;
  fields.emplace_back(test::fog_ball(19), 0.5F);
  for (const float iso : {0.0F, 0.7F, -1.2F}) {
    fields.emplace_back(test::ball(20), iso);
    fields.emplace_back(test::gyroid_ball(32), iso);
    fields.emplace_back(test::random_signs(20, 34, 3), iso);
  }
  fields.emplace_back(tiny_values(), 0.0F);
  std::array<int, 2> bricks{};
  for (const auto& of : fields) {
    PhiField field;
    field.volume = &of.first;
    field.iso = of.second;
    PhiSampler sampler(field), remembering(field), another(field);
    BrickSides sides(field);
    remembering.remember_in(sides);
    another.remember_in(sides);
    for_each_in_cube(-4, 4, [&](int x, int y, int z) {
      const bool one_sided = lie_on_one_side(*samples_of(of.first, 1, {x, y, z}, of.second));
      for (PhiSampler* const asked : {&sampler, &remembering, &another}) {
        EXPECT_EQ(asked->one_sided({x, y, z}), one_sided) << x << " " << y << " " << z;
      }
      ++bricks[one_sided];
    });
  }
  EXPECT_GT(bricks[0], 500);
  EXPECT_GT(bricks[1], 500);
}

TEST(PhiSampler, SaysNothingOfSidesBetweenVoxels) {
  const Volume volume = test::ball(20);
  PhiField field;
  field.volume = &volume;
  field.spacing_voxels = 1.5;
  EXPECT_FALSE(PhiSampler(field).one_sided({40, 0, 0}));
}

TEST(AxisPoints, NameEveryVoxelOnce) {
  for (const double spacing : {0.3, 0.5, 1.0, 1.7, 2.0, 5.5}) {
    const double first = -11.5;
    const AxisPoints points(first, 13, spacing);
    for (std::size_t i = 1; i < points.voxels(); ++i) {
      EXPECT_LT(points.voxel(i - 1), points.voxel(i));
    }
    for (std::size_t i = 0; i < points.count(); ++i) {
      const std::size_t before = points.before(i);
      EXPECT_EQ(points.voxel(before) + 1, points.voxel(before + 1));
      EXPECT_NEAR(points.voxel(before) + static_cast<double>(points.weight(i)),
                  spacing * (first + static_cast<double>(i)), 1e-6);
    }
  }
}

}  // namespace
}  // namespace tet
