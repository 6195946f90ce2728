// Lattices with sheets, thin walls and zeros of all kinds, for tests.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <random>

#include "core/lattice/bcc.h"
#include "core/stuffing/warp.h"

namespace tet::test {

/// A sum of waves, rounded: sheets, thin walls, and nodes that are exactly zero.
class Waves {
 public:
  explicit Waves(std::uint32_t seed) : random_(seed) {
    for (Wave& wave : waves_) {
      wave = {draw(-0.7, 0.7), draw(-0.7, 0.7), draw(-0.7, 0.7), draw(0, 6.3)};
    }
    offset_ = draw(-1, 1);
    steps_ = draw(0.6, 8);
  }
  long operator()(LatticeCoord at) const {
    double sum = offset_;
    for (const auto& [x, y, z, phase] : waves_) {
      sum += std::sin(0.5 * (x * at.x + y * at.y + z * at.z) + phase);
    }
    return std::lround(steps_ * sum);
  }

 private:
  struct Wave {
    double x, y, z, phase;
  };
  double draw(double low, double high) {
    return std::uniform_real_distribution(low, high)(random_);
  }

  std::mt19937 random_;
  std::array<Wave, 3> waves_;
  double offset_ = 0, steps_ = 1;
};

/// The nodes of a cube, those of [-1, 8]^3 if a brick is asked what it sees, by the sign of
/// `value_of` their doubled coordinates.
template <class ValueOf>
std::unique_ptr<WarpedLattice> lattice_of(const ValueOf& value_of,
                                          const HaloSet& cube = halo_cube(-1, 8)) {
  auto lattice = std::make_unique<WarpedLattice>();
  for (const NodeKind kind : {kCorner, kCentre}) {
    for_each_bit(cube, [&](int index) {
      const auto value = value_of(node_coord(kind, index));
      if (value > 0) lattice->plus[kind].set(index);
      if (value == 0) lattice->zero[kind].set(index);
    });
  }
  return lattice;
}

}  // namespace tet::test
