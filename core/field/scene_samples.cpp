#include "core/field/scene_samples.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace tet {
namespace {

constexpr std::size_t kCorners = 13, kCentres = 12;  // along each axis of a halo

/// World coordinates of a halo's nodes of one kind along an axis: of a node alone, not of the
/// brick that sees it.
struct AxisNodes {
  std::array<double, kCorners> at{};

  AxisNodes(double first, std::size_t count, double spacing) noexcept {
    for (std::size_t i = 0; i < count; ++i) {
      at[i] = spacing * (first + static_cast<double>(i));
    }
  }
};

/// Samples count^3 nodes, slice by slice; the first lies at brick cell kHaloMin + `shift`.
void sample_nodes(SceneEvaluator& evaluator,
                  double spacing,
                  BrickCoord brick,
                  double shift,
                  std::size_t count,
                  std::array<float, kHaloNodes>& column) noexcept {
  const auto nodes = [&](std::int32_t at) {
    return AxisNodes(8.0 * at + kHaloMin + shift, count, spacing);
  };
  const AxisNodes x = nodes(brick.x), y = nodes(brick.y), z = nodes(brick.z);
  scene::Points points;
  for (std::size_t j = 0; j < count; ++j) {
    for (std::size_t k = 0; k < count; ++k) {
      points.y[j * count + k] = y.at[j];
      points.z[j * count + k] = z.at[k];
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    std::fill_n(points.x.begin(), count * count, x.at[i]);
    const double* phi = evaluator.evaluate(points, count * count);
    for (std::size_t j = 0; j < count; ++j) {
      float* const row = &column[i * kHaloSlice + j * kHaloRow];
      for (std::size_t k = 0; k < count; ++k) row[k] = PhiField::clamped(*phi++);
    }
  }
}

}  // namespace

void focus_on_samples(SceneEvaluator& evaluator, double spacing, BrickCoord brick) noexcept {
  constexpr double kMiddle = 4, kHalfEdge = 6;  // of a brick and its halo, cells
  evaluator.focus({spacing * (8.0 * brick.x + kMiddle), spacing * (8.0 * brick.y + kMiddle),
                   spacing * (8.0 * brick.z + kMiddle)},
                  spacing * kHalfEdge);
}

void sample_scene(SceneEvaluator& evaluator,
                  double spacing,
                  BrickCoord brick,
                  BrickSamples& samples) noexcept {
  focus_on_samples(evaluator, spacing, brick);
  sample_nodes(evaluator, spacing, brick, 0, kCorners, samples.corner);
  sample_nodes(evaluator, spacing, brick, 0.5, kCentres, samples.centre);
}

}  // namespace tet
