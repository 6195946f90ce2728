// Where on the lattice a point lies.
#pragma once

#include <array>

#include "core/lattice/bcc.h"

namespace tet::test {

/// At a node (both ends are it), on an edge between two, or on neither.
struct LatticePlace {
  LatticeCoord low, high;
  bool on_lattice = false;

  bool is_node() const noexcept { return low == high; }
};

/// The place of a point, in half lattice spacings, within what rounding to float32 moves it.
LatticePlace place_on_lattice(const std::array<double, 3>& p);

}  // namespace tet::test
