// The box that a mesh of one side ends at: its faces cut the inside clean.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/base/types.h"
#include "core/field/find_bricks.h"
#include "core/lattice/bcc.h"

namespace tet {

/// Faces of the box that something lies in, one bit each.
enum CutFace : std::uint8_t {
  kCutLowerX = 1,
  kCutUpperX = 2,
  kCutLowerY = 4,
  kCutUpperY = 8,
  kCutLowerZ = 16,
  kCutUpperZ = 32,
};
using CutFaces = std::uint8_t;

/// Places are in doubled finest spacings.
class CutBox {
 public:
  explicit CutBox(const BrickBox& bricks) noexcept
      : min_(lower_corner(bricks.min)),
        max_(lower_corner({bricks.max.x + 1, bricks.max.y + 1, bricks.max.z + 1})) {}

  /// The point of the box next to it.
  LatticeCoord clamped(LatticeCoord at) const noexcept {
    return {std::clamp(at.x, min_.x, max_.x), std::clamp(at.y, min_.y, max_.y),
            std::clamp(at.z, min_.z, max_.z)};
  }

  CutFaces faces_at(LatticeCoord at) const noexcept {
    int faces = 0;
    if (at.x == min_.x) faces |= kCutLowerX;
    if (at.x == max_.x) faces |= kCutUpperX;
    if (at.y == min_.y) faces |= kCutLowerY;
    if (at.y == max_.y) faces |= kCutUpperY;
    if (at.z == min_.z) faces |= kCutLowerZ;
    if (at.z == max_.z) faces |= kCutUpperZ;
    return static_cast<CutFaces>(faces);
  }

 private:
  static LatticeCoord lower_corner(BrickCoord b) noexcept {
    constexpr std::int32_t kEdge = 2 * kBrickEdge;
    return {kEdge * b.x, kEdge * b.y, kEdge * b.z};
  }

  LatticeCoord min_, max_;
};

}  // namespace tet
