#include "bench/rivals/grains.h"

#include <array>
#include <cstddef>
#include <limits>
#include <random>

namespace tet::rivals {

LabelCube make_grains(std::int32_t edge, int labels) {
  std::mt19937 random(1);
  std::vector<std::array<double, 3>> seeds(static_cast<std::size_t>(labels));
  for (auto& seed : seeds) {
    for (double& v : seed) v = edge * static_cast<double>(random()) / 0x1p32;
  }
  constexpr double kRadius = 0.45;  // of the edge
  const double middle = 0.5 * (edge - 1), radius = kRadius * edge;
  const auto square = [](double v) { return v * v; };
  LabelCube cube{edge, {}};
  for (std::int32_t z = 0; z < edge; ++z) {
    for (std::int32_t y = 0; y < edge; ++y) {
      for (std::int32_t x = 0; x < edge; ++x) {
        std::uint8_t label = 0;
        double least = std::numeric_limits<double>::infinity();
        const bool inside =
            square(x - middle) + square(y - middle) + square(z - middle) < square(radius);
        for (std::size_t i = 0; inside && i < seeds.size(); ++i) {
          const auto& [a, b, c] = seeds[i];
          const double far = square(a - x) + square(b - y) + square(c - z);
          if (far >= least) continue;
          least = far;
          label = static_cast<std::uint8_t>(i + 1);
        }
        cube.label.push_back(label);
      }
    }
  }
  return cube;
}

}  // namespace tet::rivals
