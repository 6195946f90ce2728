// Where lattice points lie among a mesh's stored positions.
#pragma once

#include <array>

#include "core/base/types.h"

namespace tet {

/// From lattice coordinates to stored positions: linear * (lattice - origin).
struct LatticeToWorld {
  std::array<std::array<double, 3>, 3> linear{};
  VoxelCoord origin;  ///< a lattice corner; stored positions are relative to it
  bool mirrors =
      false;  ///< the map turns positive tets negative, so two of their nodes are swapped

  friend bool operator==(const LatticeToWorld&, const LatticeToWorld&) = default;
};

}  // namespace tet
