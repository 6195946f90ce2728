#include "core/scene/compile.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <type_traits>
#include <utility>

#include <absl/strings/str_format.h>

#include "core/scene/scene.h"
#include "core/scene/waves.h"
#include "core/volume/inside.h"
#include "core/volume/to_voxel.h"

namespace tet::scene {
namespace {

/// Instructions that each node becomes, copies counted; a double, as counts multiply.
double instructions_of(const Node& node, double of_parts, double parts) {
  if (const auto* combination = std::get_if<Combination>(&node.kind)) {
    const bool difference = combination->how == Combine::kDifference;
    return of_parts + (difference ? 2 : 1) * (parts - 1);
  }
  if (const auto* repeat = std::get_if<Repeat>(&node.kind)) {
    const double copies = 1.0 * repeat->count[0] * repeat->count[1] * repeat->count[2];
    return copies * (of_parts + 1) - 1;
  }
  return of_parts + (std::holds_alternative<Transform>(node.kind) ? 0 : 1) +
         (std::holds_alternative<PeriodicSurface>(node.kind) ? 1 : 0);
}

using Matrix = std::array<Triple, 3>;

/// The frame that first does what `frame` does, then `linear` * p + `translation`.
Frame then(const Frame& frame, const Matrix& linear, const Triple& translation) {
  Frame out;
  out.scale = frame.scale;
  for (std::size_t row = 0; row < 3; ++row) {
    out.translation[row] = translation[row];
    for (std::size_t k = 0; k < 3; ++k) {
      out.translation[row] += linear[row][k] * frame.translation[k];
    }
    for (std::size_t column = 0; column < 3; ++column) {
      double sum = 0;
      for (std::size_t k = 0; k < 3; ++k) sum += linear[row][k] * frame.linear[k][column];
      out.linear[row][column] = sum;
    }
  }
  return out;
}

Frame moved(const Frame& frame, const Triple& by) {
  return then(frame, {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {-by[0], -by[1], -by[2]});
}

Triple unit(const Triple& direction) {
  // Scaled first, so that no square leaves a double's range.
  const double most =
      std::max({std::abs(direction[0]), std::abs(direction[1]), std::abs(direction[2])});
  const Triple d{direction[0] / most, direction[1] / most, direction[2] / most};
  const double length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  return {d[0] / length, d[1] / length, d[2] / length};
}

/// Turns back by an angle about an axis: Rodrigues' formula, transposed.
Matrix turned_back(const Triple& axis, double turns) {
  const auto [x, y, z] = unit(axis);
  const double s = sin_of_turns(turns), c = cos_of_turns(turns), d = 1 - c;
  return {{{c + x * x * d, x * y * d + z * s, x * z * d - y * s},
           {x * y * d - z * s, c + y * y * d, y * z * d + x * s},
           {x * z * d + y * s, y * z * d - x * s, c + z * z * d}}};
}

/// Divides by the scales; a distance of the scaled world is at least the smallest times one's
/// own.
Frame unscaled(const Frame& frame, const Triple& scale) {
  Frame out = then(frame, {{{1 / scale[0], 0, 0}, {0, 1 / scale[1], 0}, {0, 0, 1 / scale[2]}}},
                   {0, 0, 0});
  out.scale *= std::min({scale[0], scale[1], scale[2]});
  return out;
}

/// Extends a frame to a grid's index space.
Frame to_voxels(const Frame& frame, const VoxelTransform& transform) {
  const InverseLinear inverse(transform);
  Matrix linear = inverse.row;
  for (Triple& row : linear) {
    for (double& entry : row) entry *= 1 / inverse.divisor;
  }
  return then(moved(frame, transform.translation), linear, {0, 0, 0});
}

/// Writes the program, node by node from the last one down.
class Compiler {
 public:
  Compiler(const Description& description, const Parts& parts)
      : description_(description), parts_(parts) {}

  /// `frame` leads from the world to the node's own coordinates.
  void add(std::uint32_t node, const Frame& frame) {
    const std::uint32_t begin = next();
    std::visit([&](const auto& kind) { write(node, kind, frame); },
               description_.nodes[node].kind);
    runs_.push_back({node, begin, next()});
  }
  Program take() { return {std::move(program_), std::move(runs_), std::move(grids_)}; }

 private:
  void leaf(std::uint32_t node, Op op, const Frame& frame, const Triple& size = {}) {
    program_.push_back({op, next(), node, frame, size, 0});
  }
  /// Appends an operator whose operands are the instructions since `first`.
  void operate(std::uint32_t node, Op op, std::uint32_t first, double size = 0) {
    program_.push_back({op, first, node, {}, {size, 0, 0}, 0});
  }
  std::uint32_t next() const { return static_cast<std::uint32_t>(program_.size()); }

  void write(std::uint32_t, const std::monostate&, const Frame&) {}
  void write(std::uint32_t node, const Sphere& s, const Frame& frame) {
    leaf(node, Op::kSphere, frame, {s.radius, 0, 0});
  }
  void write(std::uint32_t node, const Ellipsoid& e, const Frame& frame) {
    leaf(node, Op::kSphere, unscaled(frame, e.semi_axes), {1, 0, 0});
  }
  void write(std::uint32_t node, const RoundedBox& b, const Frame& frame) {
    const std::uint32_t first = next();
    leaf(node, Op::kRoundedBox, frame,
         {b.size[0] / 2 - b.rounding, b.size[1] / 2 - b.rounding, b.size[2] / 2 - b.rounding});
    if (b.rounding > 0) operate(node, Op::kOffset, first, frame.scale * b.rounding);
  }
  void write(std::uint32_t node, const Cylinder& c, const Frame& frame) {
    leaf(node, Op::kCylinder, frame, {c.radius, c.height / 2, 0});
  }
  void write(std::uint32_t node, const Cone& c, const Frame& frame) {
    leaf(node, Op::kCone, frame, {c.bottom_radius, c.top_radius, c.height / 2});
  }
  void write(std::uint32_t node, const Torus& t, const Frame& frame) {
    leaf(node, Op::kTorus, frame, {t.major_radius, t.minor_radius, 0});
  }
  void write(std::uint32_t node, const Capsule& c, const Frame& frame) {
    leaf(node, Op::kCapsule, frame, {c.radius, c.length / 2, 0});
  }
  void write(std::uint32_t node, const HalfSpace& h, const Frame& frame) {
    leaf(node, Op::kHalfSpace,
         then(frame, {{{0, 0, 0}, {0, 0, 0}, unit(h.normal)}}, {0, 0, -h.offset}));
  }
  void write(std::uint32_t node, const PeriodicSurface& p, const Frame& frame) {
    constexpr std::array kOps{Op::kGyroid, Op::kSchwarzP, Op::kDiamond};
    const std::uint32_t first = next();
    const double per = 1 / p.period;
    Frame turns = then(frame, {{{per, 0, 0}, {0, per, 0}, {0, 0, per}}}, {0, 0, 0});
    // The three slopes' squares add up to 3 at most, per radian.
    turns.scale *= p.period / (2 * std::numbers::pi * std::numbers::sqrt3);
    leaf(node, kOps[static_cast<std::size_t>(p.kind)], turns);
    if (p.thickness) operate(node, Op::kShell, first, frame.scale * *p.thickness / 2);
  }

  void write(std::uint32_t node, const GridSolid& g, const Frame& frame) {
    const double iso = g.iso.value_or(default_iso(*g.volume, g.inside));
    const double sign = inside_side(*g.volume, g.inside) == InsideSide::kAbove ? -1 : 1;
    leaf(node, Op::kGrid, to_voxels(frame, g.volume->transform), {iso, sign, 0});
    program_.back().grid = number_of(g.volume);
  }
  std::uint32_t number_of(const std::shared_ptr<const Volume>& grid) {
    const auto known = std::find(grids_.begin(), grids_.end(), grid);
    const auto number = static_cast<std::uint32_t>(known - grids_.begin());
    if (known == grids_.end()) grids_.push_back(grid);
    return number;
  }

  void write(std::uint32_t node, const Combination& c, const Frame& frame) {
    const std::uint32_t first = next();
    const Op op = c.how == Combine::kUnion ? Op::kMin : Op::kMax;
    for (const std::uint32_t part : parts_[node]) {
      const std::uint32_t begin = next();
      add(part, frame);
      if (begin == first) continue;
      if (c.how == Combine::kDifference) operate(node, Op::kNegate, begin);
      operate(node, op, first, frame.scale * c.smoothing);
    }
  }
  void write(std::uint32_t node, const Offset& o, const Frame& frame) {
    const std::uint32_t first = next();
    add(parts_[node][0], frame);
    operate(node, Op::kOffset, first, frame.scale * o.distance);
  }
  void write(std::uint32_t node, const Shell& s, const Frame& frame) {
    const std::uint32_t first = next();
    add(parts_[node][0], frame);
    operate(node, Op::kShell, first, frame.scale * s.thickness / 2);
  }
  void write(std::uint32_t node, const Transform& t, const Frame& frame) {
    const Frame turned =
        then(moved(frame, t.translation), turned_back(t.axis, t.angle_deg / 360), {0, 0, 0});
    add(parts_[node][0], unscaled(turned, t.scale));
  }
  void write(std::uint32_t node, const Repeat& r, const Frame& frame) {
    const std::uint32_t first = next();
    for (int x = 0; x < r.count[0]; ++x) {
      for (int y = 0; y < r.count[1]; ++y) {
        for (int z = 0; z < r.count[2]; ++z) {
          const bool is_first = next() == first;
          add(parts_[node][0], moved(frame, {x * r.step[0], y * r.step[1], z * r.step[2]}));
          if (!is_first) operate(node, Op::kMin, first);
        }
      }
    }
  }

  const Description& description_;
  const Parts& parts_;
  std::vector<Instruction> program_;
  std::vector<NodeRun> runs_;
  std::vector<std::shared_ptr<const Volume>> grids_;
};

/// Volumes of a primitive's own space for one of the world's; of a half-space, which has but
/// one axis, the length of that.
double determinant_of(const Instruction& op) {
  const auto& [x, y, z] = op.frame.linear;
  if (op.op == Op::kHalfSpace) return std::hypot(z[0], z[1], z[2]);
  return x[0] * (y[1] * z[2] - y[2] * z[1]) - x[1] * (y[0] * z[2] - y[2] * z[0]) +
         x[2] * (y[0] * z[1] - y[1] * z[0]);
}

bool has_finite_places(const Instruction& op) {
  const auto finite = [](double value) { return std::isfinite(value); };
  return std::ranges::all_of(op.size, finite) &&
         std::ranges::all_of(op.frame.translation, finite);
}

}  // namespace

absl::Status check_instructions(const Description& description, const Parts& parts) {
  std::vector<double> count(parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    double of_parts = 0;
    for (const std::uint32_t part : parts[i]) of_parts += count[part];
    count[i] =
        instructions_of(description.nodes[i], of_parts, static_cast<double>(parts[i].size()));
    if (count[i] <= static_cast<double>(Scene::kMaxInstructions)) continue;
    return absl::InvalidArgumentError(absl::StrFormat(
        "%s is %.6g primitives and operators, every copy counted; the limit is %d",
        path_of(description, i), count[i], Scene::kMaxInstructions));
  }
  return absl::OkStatus();
}

absl::Status check_frames(const Description& description,
                          const std::vector<Instruction>& program) {
  constexpr double kLeastScale = 1e-60, kMostScale = 1e60;  // their cubes are doubles by far
  for (const Instruction& op : program) {
    const double scale = op.frame.scale;
    const double determinant = determinant_of(op);
    if (!(scale >= kLeastScale && scale <= kMostScale)) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "%s is scaled by %g by itself and the transforms around it, which is not from %g to "
          "%g: scale it by less, or in fewer transforms",
          path_of(description, op.node), scale, kLeastScale, kMostScale));
    }
    if (!std::isnormal(determinant) || !has_finite_places(op)) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "%s has the determinant %g by the transforms around it, and that or where it lies is "
          "0, nearly 0 or not finite: scale and move it by less, or in fewer transforms",
          path_of(description, op.node), determinant));
    }
  }
  return absl::OkStatus();
}

std::size_t deepest_stack(const std::vector<Instruction>& program) {
  std::size_t depth = 0, deepest = 0;
  for (const Instruction& op : program) {
    if (is_leaf(op.op)) deepest = std::max(deepest, ++depth);
    if (is_binary(op.op)) --depth;
  }
  return deepest;
}

Program compile(const Description& description, const Parts& parts) {
  Compiler compiler(description, parts);
  compiler.add(static_cast<std::uint32_t>(parts.size() - 1), {});
  return compiler.take();
}

}  // namespace tet::scene
