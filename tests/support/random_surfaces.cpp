#include "tests/support/random_surfaces.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "core/surface/orient_surface.h"
#include "tests/support/surfaces.h"

namespace tet::test {
namespace {

/// Whole numbers and fractions that every standard library makes alike.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed * 0x9E3779B97F4A7C15ULL + 1) {}

  double between(double low, double high) {
    return low + (high - low) * std::ldexp(static_cast<double>(engine_() >> 11), -53);
  }
  std::size_t below(std::size_t count) { return engine_() % count; }
  bool one_in(std::size_t count) { return below(count) == 0; }

 private:
  std::mt19937_64 engine_;
};

std::vector<double> random_planes(Dice& dice) {
  std::vector<double> planes{0};
  const std::size_t count = 2 + dice.below(3);
  for (std::size_t i = 0; i < count; ++i) {
    // Thin ones are half of them.
    planes.push_back(planes.back() +
                     (dice.one_in(2) ? dice.between(0.5, 3) : dice.between(3, 8)));
  }
  const double middle = planes.back() / 2 + dice.between(-0.5, 0.5);
  for (double& plane : planes) plane -= middle;
  return planes;
}

/// A solid of blocks; in voxels.
Blocks random_blocks(Dice& dice) {
  Blocks blocks{{random_planes(dice), random_planes(dice), random_planes(dice)}, {}};
  const std::size_t count = (blocks.planes[0].size() - 1) * (blocks.planes[1].size() - 1) *
                            (blocks.planes[2].size() - 1);
  while (blocks.full.size() < count) blocks.full.push_back(dice.one_in(3) ? 0 : 1);
  // A solid of thick walls is among them, or nothing would be left to be right about.
  blocks.full[dice.below(count)] = 1;
  return blocks;
}

struct Shape {
  TriangleSurface surface;
  double volume = 0;
  std::string what;
};

Shape blocks_shape(Dice& dice) {
  const Blocks blocks = random_blocks(dice);
  return {blocks.surface(), blocks.volume(), "blocks"};
}

Shape hollow_sphere(Dice& dice) {
  const double radius = dice.between(6, 14), wall = dice.between(0.5, 4);
  const auto outer = sphere_surface({}, radius, 32);
  const auto inner = sphere_surface({}, radius - wall, 32);
  return {joined(outer, inside_out(inner)), volume_of(outer) - volume_of(inner),
          "hollow sphere"};
}

Shape overlapping_boxes(Dice& dice) {
  const double a = dice.between(4, 12), b = dice.between(4, 12);
  const double shift = dice.between(0.1, 1.2) * std::min(a, b);
  const double overlap = std::max(0.0, std::min(a, shift + b) - shift);
  const double low = std::min(a, b);  // the second stands on the first's lowest corner
  return {
      joined(box_surface({0, 0, 0}, {a, a, a}), box_surface({shift, 0, 0}, {shift + b, b, b})),
      a * a * a + b * b * b - overlap * low * low, "overlapping boxes"};
}

Shape two_spheres(Dice& dice) {
  const double r = dice.between(4, 9), s = dice.between(4, 9), gap = dice.between(0.5, 3);
  const auto one = sphere_surface({}, r, 24), two = sphere_surface({r + gap + s, 0, 0}, s, 24);
  const bool turned = dice.one_in(3);
  return {joined(one, turned ? inside_out(two) : two), volume_of(one) + volume_of(two),
          turned ? "two spheres, one inside out" : "two spheres"};
}

Shape random_bottle(Dice& dice) {
  const double outer = dice.between(16, 24), wall = dice.between(1, 4);
  const Blocks blocks = bottle(outer, wall, dice.between(0.5, 4));
  return {blocks.surface(), blocks.volume(), "bottle"};
}

Shape random_shape(Dice& dice) {
  switch (dice.below(6)) {
    case 0:
      return hollow_sphere(dice);
    case 1:
      return overlapping_boxes(dice);
    case 2:
      return two_spheres(dice);
    case 3:
      return random_bottle(dice);
    default:
      return blocks_shape(dice);
  }
}

void flip_some(Dice& dice, Shape& shape) {
  for (std::size_t i = 0; i < shape.surface.triangles.size(); ++i) {
    if (dice.one_in(10)) turn(shape.surface.triangles[i]);
  }
  shape.what += ", some triangles turned";
}

void double_some(Dice& dice, Shape& shape) {
  const std::size_t count = shape.surface.triangles.size();
  for (std::size_t i = 0; i < count; ++i) {
    if (dice.one_in(3)) shape.surface.triangles.push_back(shape.surface.triangles[i]);
  }
  shape.what += ", some triangles doubled";
}

void jitter(Dice& dice, Shape& shape) {
  shape.surface = torn(shape.surface);
  for (WorldPoint& p : shape.surface.vertices) {
    p = {p.x + dice.between(-1e-6, 1e-6), p.y + dice.between(-1e-6, 1e-6),
         p.z + dice.between(-1e-6, 1e-6)};
  }
  shape.what += ", torn by 1e-6 voxels";
}

void spoil(Dice& dice, Shape& shape) {
  switch (dice.below(8)) {
    case 0:
      return flip_some(dice, shape);
    case 1:
      return double_some(dice, shape);
    case 2:
      return jitter(dice, shape);
    case 3:
      shape.surface = inside_out(shape.surface);
      shape.what += ", inside out";
      return;
    case 4:
      shape.surface = without(shape.surface, dice.below(shape.surface.triangles.size()), 1);
      shape.what += ", one triangle missing";
      return;
    default:
      return;
  }
}

}  // namespace

RandomSurface random_surface(std::uint64_t seed) {
  Dice dice(seed);
  Shape shape = random_shape(dice);
  RandomSurface result;
  for (const auto& t : shape.surface.triangles) result.area += twice_area(shape.surface, t) / 2;
  spoil(dice, shape);
  const double voxel = std::pow(10, dice.between(-9, 9));
  const double far = dice.one_in(2) ? 0 : voxel * std::pow(10, dice.between(0, 9));
  const WorldPoint at{far * dice.between(-1, 1), far * dice.between(-1, 1),
                      far * dice.between(-1, 1)};
  result.surface =
      placed(rotated(shape.surface, dice.one_in(3) ? 0 : dice.between(0, 6)), voxel, at);
  result.voxel_size = voxel;
  result.volume = shape.volume * voxel * voxel * voxel;
  result.area *= voxel * voxel;
  result.what = shape.what;
  return result;
}

}  // namespace tet::test
