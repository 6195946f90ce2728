// Values of a scene: at many points at once, and bounds around one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/base/types.h"
#include "core/scene/instruction.h"
#include "core/scene/scene.h"

namespace tet {

/// Evaluates a scene. Not thread-safe: one per task. The scene must outlive it.
///
/// A point's value depends on the point alone: not on those beside it in a column, nor on where
/// the evaluator is focused.
class SceneEvaluator {
 public:
  explicit SceneEvaluator(const Scene& scene);

  /// Until the next focus most points lie within `reach` of `centre`: parts that cannot matter
  /// there are left out. At first everywhere is in focus.
  void focus(const WorldPoint& centre, double reach) noexcept;

  /// True only if the two have the same values at every point that both are focused on.
  bool same_in_focus(const SceneEvaluator& other) const noexcept;

  /// phi of the first `count` points of `points`, all of them in focus; they stay until the
  /// next call.
  const double* evaluate(const scene::Points& points, std::size_t count) noexcept;

  /// phi at any point, in focus or not.
  double at(const WorldPoint& p) noexcept;

 private:
  const Scene* scene_;
  WorldPoint centre_;  ///< of the focus
  double reach_ = std::numeric_limits<double>::infinity();
  std::vector<std::uint32_t> active_;  ///< instructions of the focus, in order
  std::vector<std::uint32_t> all_;
  std::vector<scene::Values> stack_;
  std::vector<double> values_;  ///< of each instruction, where it is focused
  std::vector<bool> wanted_;

  const double* run(const std::vector<std::uint32_t>& program,
                    const scene::Points& points,
                    std::size_t count) noexcept;
  void evaluate_each(const WorldPoint& p) noexcept;
  /// Which of a binary operator's parts alone is its value within `reach`: 0 where both are.
  std::uint32_t only_part(std::uint32_t op, double reach, double rounding) const noexcept;
  std::uint32_t left_of(std::uint32_t op) const noexcept {
    return scene_->program[op - 1].first - 1;
  }
};

}  // namespace tet
