#include "tests/support/random_fields.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "tests/support/volume_fixtures.h"

namespace tet::test {
namespace {

/// Random numbers that belong to a voxel, whatever the order in which voxels are asked for.
class VoxelRandom {
 public:
  VoxelRandom(std::uint32_t seed, VoxelCoord voxel) : state_(seed) {
    for (const std::int32_t c : {voxel.x, voxel.y, voxel.z}) {
      state_ = next() ^ static_cast<std::uint32_t>(c);
    }
  }

  /// splitmix64.
  std::uint64_t next() {
    std::uint64_t x = state_ += 0x9e3779b97f4a7c15U;
    x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
    x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
    return x ^ (x >> 31U);
  }
  /// 0 .. count - 1.
  int below(int count) { return static_cast<int>(next() % static_cast<std::uint64_t>(count)); }
  /// In [low, high).
  double within(double low, double high) {
    return low + (high - low) * std::ldexp(static_cast<double>(next() >> 11U), -53);
  }

 private:
  std::uint64_t state_;
};

/// Where a field lies: anywhere, so that bricks cut it differently every time.
VoxelBox box_of(std::uint32_t seed, int edge) {
  VoxelRandom random(seed, {});
  const auto start = [&] { return random.below(80) - 40 - edge / 2; };
  const VoxelCoord min{start(), start(), start()};
  return {min, {min.x + edge - 1, min.y + edge - 1, min.z + edge - 1}};
}

RandomField made(std::uint32_t seed, int edge, const VoxelFunction& value) {
  return {dense_volume(box_of(seed, edge), 1, value), 0, std::nullopt};
}

RandomField signs(std::uint32_t seed, int edge) {
  return made(seed, edge, [=](VoxelCoord v) {
    return static_cast<float>(VoxelRandom(seed, v).within(-1, 1));
  });
}

RandomField zeros(std::uint32_t seed, int edge) {
  const int largest = 1 + static_cast<int>(seed % 4);
  return made(seed, edge, [=](VoxelCoord v) {
    return static_cast<float>(VoxelRandom(seed, v).below(2 * largest + 1) - largest);
  });
}

RandomField denormals(std::uint32_t seed, int edge) {
  return made(seed, edge, [=](VoxelCoord v) {
    VoxelRandom random(seed, v);
    const float sign = random.below(2) == 0 ? -1 : 1;
    const int kind = random.below(10);
    if (kind == 0) return 0.0F;
    if (kind == 1) return sign;
    const auto bits = static_cast<std::uint32_t>(random.next()) & 0x7fffffU;
    return sign * std::bit_cast<float>(bits >> random.below(23));  // zero exponent: denormal
  });
}

RandomField magnitudes(std::uint32_t seed, int edge) {
  constexpr double kMax = std::numeric_limits<float>::max();
  return made(seed, edge, [=](VoxelCoord v) {
    VoxelRandom random(seed, v);
    const double sign = random.below(2) == 0 ? -1 : 1;
    return static_cast<float>(sign * std::min(kMax, std::pow(10, random.within(-45, 38.6))));
  });
}

/// Blocks of 16 voxels, each with one kind of feature.
RandomField specks(std::uint32_t seed, int edge) {
  return made(seed, edge, [=](VoxelCoord v) {
    VoxelRandom block(~seed, {v.x >> 4, v.y >> 4, v.z >> 4});
    VoxelRandom random(seed, v);
    const int kind = block.below(5), axis = block.below(3), step = 3 + block.below(3);
    const bool grain = random.below(12) == 0;
    const std::array<int, 3> at{v.x & 15, v.y & 15, v.z & 15};
    const auto on = [&](int shift) {
      return at[static_cast<std::size_t>(axis + shift) % 3] % step == 0;
    };
    bool inside = false;
    if (kind == 0) inside = grain;                      // grains
    if (kind == 1) inside = !grain;                     // pinholes
    if (kind == 2) inside = on(0);                      // sheets
    if (kind == 3) inside = on(0) && on(1);             // rods
    if (kind == 4) inside = on(0) != (grain && on(1));  // sheets with holes and bridges
    const double value = random.within(0.05, 1);
    return static_cast<float>(inside ? -value : value);
  });
}

/// Whole numbers: the rows of a half space x*a + y*b + z*c <= d / 2.
struct HalfSpace {
  std::array<int, 3> normal{};
  int twice_offset = 0;

  double phi(VoxelCoord v) const {
    return normal[0] * v.x + normal[1] * v.y + normal[2] * v.z - 0.5 * twice_offset;
  }
};

HalfSpace symmetric_plane(VoxelRandom& random, const VoxelBox& box) {
  constexpr std::array<std::array<int, 3>, 7> kNormals{
      {{1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {2, 1, 0}, {2, 1, 1}, {2, 2, 1}, {3, 1, 1}}};
  HalfSpace plane{kNormals[static_cast<std::size_t>(random.below(7))], 0};
  std::rotate(plane.normal.begin(), plane.normal.begin() + random.below(3), plane.normal.end());
  for (int& n : plane.normal) n *= random.below(2) == 0 ? -1 : 1;
  // Through a node somewhere in the middle half of the box.
  const int edge = box.max.x - box.min.x + 1;
  const auto inner = [&](int from) { return from + edge / 4 + random.below(edge / 2); };
  const VoxelCoord through{inner(box.min.x), inner(box.min.y), inner(box.min.z)};
  plane.twice_offset = static_cast<int>(2 * plane.phi(through)) + random.below(2);
  return plane;
}

/// Intersections of three half spaces, two of them united.
RandomField planes(std::uint32_t seed, int edge) {
  const VoxelBox box = box_of(seed, edge);
  VoxelRandom random(seed, {1, 2, 3});
  std::array<HalfSpace, 6> plane;
  for (HalfSpace& p : plane) p = symmetric_plane(random, box);
  return made(seed, edge, [=](VoxelCoord v) {
    const auto corner = [&](std::size_t i) {
      return std::max({plane[i].phi(v), plane[i + 1].phi(v), plane[i + 2].phi(v)});
    };
    return static_cast<float>(std::min(corner(0), corner(3)));
  });
}

struct Wave {
  double x, y, z, phase;
};

std::vector<Wave> random_waves(std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> direction;
  std::uniform_real_distribution<double> length(9, 30), phase(0, 2 * std::numbers::pi);
  std::vector<Wave> waves;
  for (int i = 0; i < 5; ++i) {
    const double x = direction(random), y = direction(random), z = direction(random);
    const double scale = 2 * std::numbers::pi / (length(random) * std::hypot(x, y, z));
    waves.push_back({scale * x, scale * y, scale * z, phase(random)});
  }
  return waves;
}

double sum_of(const std::vector<Wave>& waves, VoxelCoord v) {
  double sum = 0;
  for (const Wave& w : waves) sum += std::sin(w.x * v.x + w.y * v.y + w.z * v.z + w.phase);
  return sum;
}

RandomField noise(std::uint32_t seed, int edge) {
  const auto waves = random_waves(seed);
  RandomField field =
      made(seed, edge, [&](VoxelCoord v) { return static_cast<float>(sum_of(waves, v)); });
  field.max_surface_phi = 0.1;  // up to 0.04 at the edges of the box
  return field;
}

RandomField plateaus(std::uint32_t seed, int edge) {
  const auto waves = random_waves(seed);
  return made(seed, edge, [&](VoxelCoord v) {
    return static_cast<float>(std::round(2 * sum_of(waves, v)) / 2);
  });
}

/// One of the shapes that fill a block of kBlock voxels.
struct Shape {
  enum Kind : std::uint8_t { kNothing, kBall, kTorus, kHollowBall } kind = kNothing;
  WorldPoint centre, axis;
  double radius = 0;

  double phi(VoxelCoord v) const {
    const double x = v.x - centre.x, y = v.y - centre.y, z = v.z - centre.z;
    const double r = std::hypot(x, y, z);
    if (kind == kBall) return r - radius;
    if (kind == kHollowBall) return std::max(r - radius, 0.45 * radius - r);
    const double along = x * axis.x + y * axis.y + z * axis.z;
    const double ring = std::sqrt(std::max(0.0, r * r - along * along)) - 0.65 * radius;
    return std::hypot(ring, along) - 0.3 * radius;
  }
};

constexpr int kBlock = 32;
constexpr float kBand = 3;

Shape shape_in(std::uint32_t seed, VoxelCoord block, bool lowest) {
  VoxelRandom random(seed, block);
  Shape shape;
  // At least one block of a field, the one at its lowest corner, is never empty.
  shape.kind = static_cast<Shape::Kind>(lowest ? 1 + random.below(3) : random.below(4));
  const auto middle = [&](std::int32_t b) { return kBlock * (b + 0.5) + random.within(-1, 1); };
  shape.centre = {middle(block.x), middle(block.y), middle(block.z)};
  const double x = random.within(-1, 1), y = random.within(-1, 1), z = random.within(0.1, 1);
  const double length = std::hypot(x, y, z);
  shape.axis = {x / length, y / length, z / length};
  // The thinnest is a torus of 0.6 * 10 voxels; balls may be smaller, hollow ones may not.
  shape.radius = random.within(shape.kind == Shape::kBall ? 4 : 10, 12);
  return shape;
}

RandomField shapes(std::uint32_t seed, int edge) {
  const int blocks = std::max(1, edge / kBlock);
  const auto shift = static_cast<std::int32_t>(seed % 5) - 2;  // in blocks
  std::vector<Shape> shape;
  Topology topology;
  for (int i = 0; i < blocks * blocks * blocks; ++i) {
    const VoxelCoord block{shift + i / (blocks * blocks), shift + i / blocks % blocks,
                           shift + i % blocks};
    shape.push_back(shape_in(seed, block, i == 0));
    constexpr std::array<Topology, 4> kTopology{{{0, 0}, {1, 2}, {1, 0}, {2, 4}}};
    topology.components += kTopology[shape.back().kind].components;
    topology.euler_characteristic += kTopology[shape.back().kind].euler_characteristic;
  }
  const std::int32_t low = shift * kBlock, high = (shift + blocks) * kBlock - 1;
  const auto phi = [&](VoxelCoord v) {
    const auto block = [&](std::int32_t c) { return (c - low) / kBlock; };
    const Shape& s = shape[static_cast<std::size_t>(
        (block(v.x) * blocks + block(v.y)) * blocks + block(v.z))];
    return s.kind == Shape::kNothing ? kBand : static_cast<float>(s.phi(v));
  };
  return {narrow_band_volume({{low, low, low}, {high, high, high}}, kBand, phi), 0.02,
          topology};
}

using Maker = RandomField (*)(std::uint32_t seed, int edge);

constexpr std::array<std::pair<std::string_view, Maker>, 9> kMakers{{{"signs", signs},
                                                                     {"zeros", zeros},
                                                                     {"plateaus", plateaus},
                                                                     {"denormals", denormals},
                                                                     {"magnitudes", magnitudes},
                                                                     {"specks", specks},
                                                                     {"planes", planes},
                                                                     {"noise", noise},
                                                                     {"shapes", shapes}}};

constexpr std::array<std::string_view, kMakers.size()> kNames = [] {
  std::array<std::string_view, kMakers.size()> names;
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = kMakers[i].first;
  return names;
}();

}  // namespace

std::span<const std::string_view> field_families() { return kNames; }

RandomField random_field(std::string_view family, std::uint32_t seed, int edge) {
  for (const auto& [name, make] : kMakers) {
    if (name == family) return make(seed, edge);
  }
  std::fprintf(stderr, "unknown family of fields\n");
  std::abort();
}

}  // namespace tet::test
