#include "core/scene/extent.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <tuple>

#include "core/scene/scene_nodes.h"
#include "core/volume/value_box.h"

namespace tet::scene {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

using Matrix3 = std::array<Triple, 3>;

struct Extent {
  Triple min{-kInf, -kInf, -kInf}, max{kInf, kInf, kInf};

  static Extent nothing() { return {{kInf, kInf, kInf}, {-kInf, -kInf, -kInf}}; }
  bool empty() const { return !(min[0] <= max[0] && min[1] <= max[1] && min[2] <= max[2]); }
};

Extent both(const Extent& a, const Extent& b) {
  Extent out;
  for (std::size_t i = 0; i < 3; ++i) {
    out.min[i] = std::max(a.min[i], b.min[i]);
    out.max[i] = std::min(a.max[i], b.max[i]);
  }
  return out.empty() ? Extent::nothing() : out;
}

Extent either(const Extent& a, const Extent& b) {
  Extent out;
  for (std::size_t i = 0; i < 3; ++i) {
    out.min[i] = std::min(a.min[i], b.min[i]);
    out.max[i] = std::max(a.max[i], b.max[i]);
  }
  return out;
}

/// Half edges of the box around a primitive, in its own units, grown by `level`.
Triple half_edges(const Instruction& leaf, double level) {
  const auto& [a, b, c] = leaf.size;
  switch (leaf.op) {
    case Op::kSphere:
      return {a + level, a + level, a + level};
    case Op::kRoundedBox:
      return {a + level, b + level, c + level};
    case Op::kCylinder:
      return {a + level, a + level, b + level};
    case Op::kCone:
      return {std::max(a, b) + level, std::max(a, b) + level, c + level};
    case Op::kTorus:
      return {a + b + level, a + b + level, b + level};
    case Op::kCapsule:
      return {a + level, a + level, a + b + level};
    default:
      return {kInf, kInf, kInf};
  }
}

Matrix3 inverse(const Matrix3& m) {
  const auto cofactor = [&](std::size_t row, std::size_t column) {
    const std::size_t r1 = (row + 1) % 3, r2 = (row + 2) % 3;
    const std::size_t c1 = (column + 1) % 3, c2 = (column + 2) % 3;
    return m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1];
  };
  const double det =
      m[0][0] * cofactor(0, 0) + m[0][1] * cofactor(0, 1) + m[0][2] * cofactor(0, 2);
  Matrix3 out;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      out[row][column] = cofactor(column, row) / det;
    }
  }
  return out;
}

/// Along an axis that the plane is square to, a half space has one end.
Extent half_space(const Instruction& leaf, double level) {
  Extent out;
  const Triple& normal = leaf.frame.linear[2];
  for (std::size_t i = 0; i < 3; ++i) {
    if (normal[(i + 1) % 3] != 0 || normal[(i + 2) % 3] != 0) continue;
    const double end = (level - leaf.frame.translation[2]) / normal[i];
    (normal[i] > 0 ? out.max : out.min)[i] = end;
  }
  return out;
}

/// Where a primitive's phi is below `level`, in its own units and frame.
Extent own_extent(const Instruction& leaf, double level) {
  const Triple half = half_edges(leaf, level);
  if (half[0] < 0 || half[1] < 0 || half[2] < 0) return Extent::nothing();
  return {{-half[0], -half[1], -half[2]}, half};
}

/// Where a grid's phi is below `level`, in its index space: no zero is more than a voxel away
/// from all that is inside.
Extent own_extent(const Instruction& leaf, double level, const Volume& volume) {
  const auto& [iso, sign, unused] = leaf.size;
  const WantedValues wanted =
      sign > 0 ? WantedValues{-kInf, iso + level} : WantedValues{iso - level, kInf};
  if (wanted.have(volume.background)) return {};
  const auto [min, max] = box_of_values(volume, wanted);
  if (min.x > max.x) return Extent::nothing();
  return {{min.x - 1.0, min.y - 1.0, min.z - 1.0}, {max.x + 1.0, max.y + 1.0, max.z + 1.0}};
}

Extent to_world(const Frame& frame, const Extent& own) {
  if (own.empty() || own.min[0] == -kInf) return own;
  const Matrix3 linear = inverse(frame.linear);
  Extent out;
  for (std::size_t i = 0; i < 3; ++i) {
    double centre = 0, reach = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      centre += linear[i][k] * ((own.min[k] + own.max[k]) / 2 - frame.translation[k]);
      reach += std::abs(linear[i][k]) * (own.max[k] - own.min[k]) / 2;
    }
    out.min[i] = centre - reach;
    out.max[i] = centre + reach;
  }
  return out;
}

/// Finds the extents of many leaves. A grid is searched once for all of its copies.
class LeafExtents {
 public:
  explicit LeafExtents(std::span<const GridSource> grids) : grids_(grids) {}

  /// Where a leaf's phi is below `level`, world units.
  Extent of(const Instruction& leaf, double level) {
    const double own_level = level / leaf.frame.scale;
    if (leaf.op == Op::kHalfSpace) return half_space(leaf, own_level);
    return to_world(leaf.frame, leaf.op == Op::kGrid ? of_grid(leaf, own_level)
                                                     : own_extent(leaf, own_level));
  }

 private:
  /// By all that the leaf says of its inside: the value, and the side of it.
  const Extent& of_grid(const Instruction& leaf, double level) {
    const auto [found, is_new] =
        of_grids_.try_emplace(std::tuple(leaf.grid, leaf.size[0], leaf.size[1], level));
    if (is_new) found->second = own_extent(leaf, level, *grids_[leaf.grid].volume);
    return found->second;
  }

  std::span<const GridSource> grids_;
  std::map<std::tuple<std::uint32_t, double, double, double>, Extent> of_grids_;
};

/// The level below which an operator's parts must be for its own value to be below `level`.
double level_of_parts(const Instruction& op, double level) {
  switch (op.op) {
    case Op::kOffset:
    case Op::kShell:
      return level + op.size[0];
    case Op::kMin:
      return level + op.size[0] / 4;  // a blend lowers by so much at most
    default:
      return level;
  }
}

/// The level that counts for each instruction, from the last one down. Nothing is known of what
/// lies below a negation: it may be anywhere.
std::vector<double> levels_of(const std::vector<Instruction>& program) {
  std::vector<double> levels(program.size(), 0);
  for (std::size_t i = program.size(); i-- > 0;) {
    const Instruction& op = program[i];
    if (is_leaf(op.op)) continue;
    levels[i - 1] = level_of_parts(op, levels[i]);
    if (is_binary(op.op)) levels[program[i - 1].first - 1] = levels[i - 1];
  }
  return levels;
}

}  // namespace

WorldBox extent_of(const std::vector<Instruction>& program, std::span<const GridSource> grids) {
  const std::vector<double> levels = levels_of(program);
  LeafExtents leaves(grids);
  std::vector<Extent> stack;
  for (std::size_t i = 0; i < program.size(); ++i) {
    const Instruction& op = program[i];
    if (is_leaf(op.op)) {
      stack.push_back(leaves.of(op, levels[i]));
    } else if (is_binary(op.op)) {
      const Extent right = stack.back();
      stack.pop_back();
      stack.back() =
          op.op == Op::kMin ? either(stack.back(), right) : both(stack.back(), right);
    } else if (op.op == Op::kNegate) {
      stack.back() = {};
    }
  }
  const auto& [min, max] = stack.back();
  return {{min[0], min[1], min[2]}, {max[0], max[1], max[2]}};
}

std::size_t endless_node(const std::vector<Instruction>& program,
                         std::span<const GridSource> grids) {
  LeafExtents leaves(grids);
  const auto endless = [&](const Instruction& op) {
    if (!is_leaf(op.op)) return false;
    return op.op == Op::kHalfSpace || leaves.of(op, 0).min[0] == -kInf;
  };
  const auto found = std::find_if(program.begin(), program.end(), endless);
  return found == program.end() ? program.back().node : found->node;
}

}  // namespace tet::scene
