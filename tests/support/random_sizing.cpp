#include "tests/support/random_sizing.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace tet::test {
namespace {

/// Draws what a sizing is made of.
class SizingWriter {
 public:
  SizingWriter(std::uint32_t seed, const WorldBox& box, double spacing)
      : random_(seed), box_(box), spacing_(spacing) {}

  Sizing sizing() {
    Sizing sizing;
    if (one_in(3)) sizing.coarsest = size();
    if (one_in(2)) sizing.growth = std::exp2(-number(0, 3));
    for (int region = 0; region < 3; ++region) {
      if (!one_in(3)) sizing.regions.push_back({size(), shape()});
    }
    return sizing;
  }

 private:
  double number(double min, double max) {
    return min + (max - min) * static_cast<double>(random_()) / 4294967295.0;
  }
  bool one_in(std::uint32_t n) { return random_() % n == 0; }
  double size() { return spacing_ * std::exp2(number(0, 4)); }
  double length() {
    return number(0.5 * spacing_, std::max(spacing_, 0.3 * (box_.max.x - box_.min.x)));
  }
  WorldPoint point() {
    const double x = number(box_.min.x, box_.max.x), y = number(box_.min.y, box_.max.y);
    return {x, y, number(box_.min.z, box_.max.z)};
  }

  decltype(SizingRegion::shape) shape() {
    switch (random_() % 4) {
      case 0: {
        const WorldPoint min = point();
        const double x = length(), y = length();
        return WorldBox{min, {min.x + x, min.y + y, min.z + length()}};
      }
      case 1: {
        const WorldPoint centre = point();
        return BallRegion{centre, length()};
      }
      case 2: {
        const WorldPoint start = point(), end = point();
        return CapsuleRegion{start, end, length() / 3};
      }
      default:
        return ShellRegion{length()};
    }
  }

  std::mt19937 random_;
  const WorldBox box_;
  const double spacing_;
};

}  // namespace

Sizing random_sizing(std::uint32_t seed, const WorldBox& box, double spacing) {
  return SizingWriter(seed, box, spacing).sizing();
}

}  // namespace tet::test
