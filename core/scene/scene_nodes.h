// A scene as its author writes it: solids, and nodes that make new solids of earlier ones.
//
// docs/scenes.md defines every kind of node. Lengths are world units unless a transform says
// otherwise; a primitive is centred at the origin, its axis along z.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/base/vec3.h"
#include "core/volume/volume.h"

namespace tet::scene {

/// x, y, z.

struct Sphere {
  double radius = 0;
};
struct Ellipsoid {
  Triple semi_axes{};
};
struct RoundedBox {
  Triple size{};        ///< whole edges, the rounding included
  double rounding = 0;  ///< radius, at most half the shortest edge
};
struct Cylinder {
  double radius = 0, height = 0;
};
struct Cone {
  double bottom_radius = 0, top_radius = 0, height = 0;  ///< one radius may be 0
};
struct Torus {
  double major_radius = 0, minor_radius = 0;
};
struct Capsule {
  double radius = 0, length = 0;  ///< length between the centres of its two half balls
};
/// Inside where dot(normal, p) < offset * |normal|.
struct HalfSpace {
  Triple normal{};
  double offset = 0;
};
enum class PeriodicKind : std::uint8_t { kGyroid, kSchwarzP, kDiamond };
/// A sheet along the surface, or without a thickness all that is on its inner side.
struct PeriodicSurface {
  PeriodicKind kind = PeriodicKind::kGyroid;
  double period = 0;
  std::optional<double> thickness;
};

enum class Combine : std::uint8_t { kUnion, kIntersection, kDifference };
/// Combines nodes, given by name. A difference takes all others off the first.
struct Combination {
  Combine how = Combine::kUnion;
  std::vector<std::string> of;
  double smoothing = 0;  ///< how far from the seam surfaces are blended; 0 keeps it sharp
};
struct Offset {
  std::string of;
  double distance = 0;  ///< outward; negative shrinks
};
struct Shell {
  std::string of;
  double thickness = 0;  ///< half on either side of the surface
};
/// Scales, then turns about an axis through the origin, then moves.
struct Transform {
  std::string of;
  Triple scale{1, 1, 1};
  Triple axis{0, 0, 1};
  double angle_deg = 0;
  Triple translation{};
};
/// The union of count[0] * count[1] * count[2] copies, moved by whole steps from 0 on.
struct Repeat {
  std::string of;
  std::array<std::int32_t, 3> count{1, 1, 1};
  Triple step{};
};

/// A stored solid: what is inside of a grid at its iso value.
struct GridSolid {
  std::string file;                                ///< for whoever loads it
  std::string name;                                ///< within the file; empty: its only one
  std::optional<double> iso;                       ///< the grid's default_iso unless given
  std::shared_ptr<const Volume> volume = nullptr;  ///< loaded before the scene is made
  std::optional<InsideSide> inside = {};           ///< as MeshRequest::inside
};

struct Node {
  std::string name;  ///< may be empty where nothing refers to it
  std::variant<std::monostate,
               Sphere,
               Ellipsoid,
               RoundedBox,
               Cylinder,
               Cone,
               Torus,
               Capsule,
               HalfSpace,
               PeriodicSurface,
               Combination,
               Offset,
               Shell,
               Transform,
               Repeat,
               GridSolid>
      kind;
};

/// Nodes refer to earlier ones only, so that there are no cycles; the last one is the scene.
struct Description {
  std::vector<Node> nodes;

  /// Nodes that are grids, in their order.
  std::vector<GridSolid*> grids();
  bool has_grids() const;
};

}  // namespace tet::scene
