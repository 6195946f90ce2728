// A scene as it is evaluated: instructions in postfix order, for a machine with a stack of
// columns.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace tet::scene {

enum class Op : std::uint8_t {
  // Leaves: each pushes a column.
  kSphere,
  kRoundedBox,
  kCylinder,
  kCone,
  kTorus,
  kCapsule,
  kHalfSpace,
  kGyroid,
  kSchwarzP,
  kDiamond,
  kGrid,
  // These take one column.
  kNegate,
  kOffset,
  kShell,
  // These take two columns.
  kMin,
  kMax,
};

constexpr bool is_leaf(Op op) noexcept { return op < Op::kNegate; }
constexpr bool is_binary(Op op) noexcept { return op >= Op::kMin; }

/// From world coordinates to a primitive's own: linear * p + translation.
struct Frame {
  std::array<std::array<double, 3>, 3> linear{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  std::array<double, 3> translation{};
  /// World units for one of the primitive's: its values are multiplied by this, so that none of
  /// a primitive changes faster than one per world unit.
  double scale = 1;

  friend bool operator==(const Frame&, const Frame&) = default;
};

struct Instruction {
  Op op = Op::kSphere;
  /// What this one's value is made of begins here; a binary one's right part ends just before
  /// it, and the left part just before that.
  std::uint32_t first = 0;
  std::uint32_t node = 0;  ///< of the description
  Frame frame;             ///< leaves only
  /// What a leaf needs, in its own units: see primitives.cpp and grid_sampler.cpp. An operator
  /// has its distance, half its thickness, or its smoothing here, in world units.
  std::array<double, 3> size{};
  std::uint32_t grid = 0;  ///< of the scene's, which a kGrid samples
};

/// The instructions that a node was written out as, the last one excluded.
struct NodeRun {
  std::uint32_t node = 0;  ///< of the description
  std::uint32_t begin = 0, end = 0;
};

/// Whether two make the same value of the same operands; if they sample grids, of the same one.
inline bool same_values(const Instruction& a, const Instruction& b) noexcept {
  return a.op == b.op && a.frame == b.frame && a.size == b.size;
}

/// Points are evaluated up to this many at a time: a slice of a brick and its halo, 13 * 13.
inline constexpr std::size_t kMaxPoints = 176;

/// World coordinates as columns.
struct Points {
  alignas(64) std::array<double, kMaxPoints> x, y, z;
};

/// A column of phi.
struct alignas(64) Values {
  std::array<double, kMaxPoints> at;
};

}  // namespace tet::scene
