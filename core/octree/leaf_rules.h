// Where an octree's leaves are, and how large they may be.
#pragma once

#include <optional>
#include <vector>

#include "core/base/brick_box.h"
#include "core/octree/cell_set.h"

namespace tet {

/// What an octree's leaves cover.
struct OctreeCover {
  /// Boxes that cover the inside (see FoundBricks), or the domain; looked at only where the
  /// number of levels keeps leaves from growing as large as they could.
  std::vector<BrickBox> boxes;
  /// Leaves cover all of it, whichever side they lie on; without it, the inside alone.
  std::optional<BrickBox> domain;
};

/// The box around boxes, of which there is one at least.
BrickBox box_around(const std::vector<BrickBox>& boxes);

/// Cells of `level` within `depth` of the surface are no leaves.
struct RefinedShell {
  int level = 1;
  double depth = 0;  ///< finest spacings
};

/// How large leaves may be.
struct LeafRules {
  int max_levels = 0;  ///< above the finest; with 0 every covered cell is a finest leaf
  /// Leaves of each size that lie one behind the other, at least, before larger ones come.
  int layers = 1;
  std::vector<CellSet> refined = {};  ///< by level, from 1 on: more cells that are no leaves
  std::vector<RefinedShell> shells = {};

  bool sized() const noexcept { return layers > 1 || !refined.empty() || !shells.empty(); }
};

}  // namespace tet
