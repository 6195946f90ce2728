#include "core/field/scene_samples.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/vector_clones.h"

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

/// A slice of a halo's samples.
using Slice = std::array<float, kCorners * kCorners>;

TET_VECTOR_CLONES
void clamp_all(const double* phi, std::size_t count, Slice& out) noexcept {
  for (std::size_t i = 0; i < count; ++i) out[i] = PhiField::clamped(phi[i]);
}

/// Samples count^3 nodes, slice by slice; the first lies at brick cell kHaloMin + `shift`.
template <std::size_t count>
void sample_nodes(SceneEvaluator& evaluator,
                  double spacing,
                  BrickCoord brick,
                  double shift,
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
  alignas(64) Slice slice;
  for (std::size_t i = 0; i < count; ++i) {
    std::fill_n(points.x.begin(), count * count, x.at[i]);
    clamp_all(evaluator.evaluate(points, count * count), count * count, slice);
    for (std::size_t j = 0; j < count; ++j) {
      std::copy_n(&slice[j * count], count, &column[i * kHaloSlice + j * kHaloRow]);
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
  sample_nodes<kCorners>(evaluator, spacing, brick, 0, samples.corner);
  sample_nodes<kCentres>(evaluator, spacing, brick, 0.5, samples.centre);
}

}  // namespace tet
