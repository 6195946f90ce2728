// What is meshed of a shape: both sides of its surface within a domain, or the inside alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/field/find_bricks.h"
#include "core/plan/mesh_request.h"
#include "core/stuffing/stuffing_rules.h"

namespace tet {

struct MeshedSpace {
  StuffingRules rules;
  /// Finest bricks, where both sides are meshed or a box cuts off the inside.
  std::optional<BrickBox> domain;
  bool manifold = false;  ///< nodes are restored until the boundary is one
  std::uint64_t kept_geometry_bytes = MeshLimits{}.kept_geometry_bytes;
  bool skip_topology = false;  ///< of the surface
  /// As many as the survey may keep: see most_surface_bricks.
  std::size_t most_bricks = kMaxSurfaceBricks;
};

}  // namespace tet
