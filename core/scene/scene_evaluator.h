// Values of a scene: at many points at once, and bounds around one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/base/cancel.h"
#include "core/base/types.h"
#include "core/scene/grid_sampler.h"
#include "core/scene/instruction.h"
#include "core/scene/scene.h"
#include "core/scene/scene_bounds.h"

namespace tet {

/// Evaluates a scene. Not thread-safe: one per task. The scene must outlive it.
///
/// A point's value depends on the point alone: not on those beside it in a column, nor on where
/// the evaluator is focused.
class SceneEvaluator {
 public:
  explicit SceneEvaluator(const Scene& scene);

  /// From now on it looks at `cancellation`, which must outlive it, after each few thousand
  /// values of an instruction: in one brick there may be a second's work. Values are made up
  /// once a look found it cancelled: discard what came of them.
  void stop_when(const Cancellation& cancellation) noexcept { cancellation_ = &cancellation; }

  /// Until the next focus most points lie in the cube around `centre`: parts that cannot matter
  /// there are left out. At first everywhere is in focus.
  void focus(const WorldPoint& centre, double half_edge) noexcept;

  /// The instructions that matter in the focus.
  const std::vector<std::uint32_t>& in_focus() const noexcept { return active_; }

  /// True only if the two have the same values at every point that both are focused on.
  bool same_in_focus(const SceneEvaluator& other) const noexcept;

  /// phi of the first `count` points of `points`, all of them in focus; they stay until the
  /// next call.
  const double* evaluate(const scene::Points& points, std::size_t count) noexcept;

  /// Bounds of phi in the cubes around those points, all of them in focus; they stay until the
  /// next call.
  const scene::PhiBounds& bounds(const scene::Points& points,
                                 std::size_t count,
                                 double half_edge) noexcept;

  /// phi at any point, in focus or not.
  double at(const WorldPoint& p) noexcept;

  /// The instruction of the primitive or grid that decides phi at any point: of two parts that
  /// are combined, blended or not, the one whose value is chosen, and the first of equals.
  std::uint32_t leaf_at(const WorldPoint& p) noexcept;

 private:
  /// Values of an instruction, each of about ten nanoseconds, that pass between two looks.
  static constexpr std::size_t kValuesPerLook = std::size_t{1} << 14;
  /// Instructions that pass before values are counted.
  static constexpr std::size_t kInstructionsAtOnce = 64;

  const Scene* scene_;
  const Cancellation* cancellation_ = nullptr;
  std::size_t since_look_ = 0;
  bool stopped_ = false;
  WorldPoint centre_;  ///< of the focus
  double half_edge_ = std::numeric_limits<double>::infinity();
  std::vector<std::uint32_t> active_;  ///< instructions of the focus, in order
  std::vector<std::uint32_t> all_;
  std::vector<scene::GridSampler> grids_;  ///< of the scene's, by their numbers
  std::vector<scene::Values> stack_;
  std::vector<std::uint32_t> leaves_;  ///< the leaf that decides each column of the stack
  std::vector<scene::PhiBounds> bounds_stack_;
  /// Bounds of one instruction's values within the focus.
  struct Interval {
    double low = 0, high = 0;
  };
  std::vector<Interval> intervals_;
  std::vector<bool> wanted_;

  void focus_program(const WorldPoint& centre, double half_edge) noexcept;
  /// Counts values that are about to be made, and looks where there were enough.
  bool stops(std::size_t values) noexcept;
  /// Calls `body` with a program's instructions in order. False once it has stopped.
  template <class Body>
  bool for_each_instruction(const std::vector<std::uint32_t>& program,
                            std::size_t count,
                            const Body& body) noexcept;
  /// The instructions that matter at a point.
  const std::vector<std::uint32_t>& program_at(const WorldPoint& p) const noexcept;
  const double* run(const std::vector<std::uint32_t>& program,
                    const scene::Points& points,
                    std::size_t count) noexcept;
  void evaluate_leaf(const scene::Instruction& leaf,
                     const scene::Points& points,
                     std::size_t count,
                     scene::Values& values) noexcept;
  void bound_leaf(const scene::Instruction& leaf,
                  const scene::Points& points,
                  std::size_t count,
                  double half_edge,
                  scene::PhiBounds& bounds) noexcept;
  void bound_each(double half_edge) noexcept;
  /// Which of a binary operator's parts alone is its value in the focus: 0 where both are.
  std::uint32_t only_part(std::uint32_t op, double rounding) const noexcept;
  std::uint32_t left_of(std::uint32_t op) const noexcept {
    return scene_->program[op - 1].first - 1;
  }
};

}  // namespace tet
