// A point of a face of the lattice, and where three labels meet on one.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "core/base/types.h"
#include "core/lattice/bcc.h"

namespace tet {

/// By its shares of the face's second and third node; the first, the lowest, has the rest.
struct FacePoint {
  float second = 0, third = 0;
  friend bool operator==(const FacePoint&, const FacePoint&) = default;
};

/// A face whose nodes have three labels, by its family (core/labels/lattice_faces.h) and the
/// halo index of its lowest node.
struct TripleFace {
  std::uint8_t family = 0;
  std::uint16_t low = 0;
  friend auto operator<=>(const TripleFace&, const TripleFace&) = default;
};

/// Where a point lies, in spacings; the face's nodes in doubled coordinates.
inline WorldPoint place_on_face(const std::array<LatticeCoord, 3>& node,
                                const FacePoint& at) noexcept {
  const LatticeCoord u = node[1] - node[0], v = node[2] - node[0];
  const double s = 0.5 * double{at.second}, t = 0.5 * double{at.third};
  return {0.5 * node[0].x + (s * u.x + t * v.x), 0.5 * node[0].y + (s * u.y + t * v.y),
          0.5 * node[0].z + (s * u.z + t * v.z)};
}

/// Where two functions are both zero that are linear on a face and have these values at its
/// nodes. Not finite where that is nowhere, or all along a line.
inline FacePoint common_zero(const std::array<double, 3>& u,
                             const std::array<double, 3>& v) noexcept {
  const double first = u[1] * v[2] - u[2] * v[1], second = u[2] * v[0] - u[0] * v[2],
               third = u[0] * v[1] - u[1] * v[0];
  const double sum = first + second + third;
  return {static_cast<float>(second / sum), static_cast<float>(third / sum)};
}

}  // namespace tet
