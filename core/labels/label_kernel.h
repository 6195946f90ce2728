// How far a voxel's label reaches when indicators are made.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace tet {

enum class LabelKernel : std::uint8_t {
  kTrilinear,  ///< to the next voxels: keeps every voxel, and every stair
  kQuadratic,  ///< a quadratic B-spline: keeps sheets one voxel thin, and most of their volume
  kGauss,      ///< a Gaussian, cut off at 2 voxels for each 0.7 of its width
};

/// The Gaussian's width, voxels: of those that were tried the one whose interfaces are flattest
/// among those that keep sheets one voxel thin whole (docs/labels.md).
inline constexpr double kDefaultSmooth = 0.7;
/// Whatever is narrower gives each node the label of the nearest voxel, as this does; much
/// narrower ones weigh nothing at all half a voxel away.
inline constexpr double kLeastSmooth = 0.05;
/// Wider kernels take more voxels a node than is worth it.
inline constexpr double kMostSmooth = 4;

/// The width of a Gaussian of `smooth` on a lattice of `spacing`, all in voxels. On a lattice
/// coarser than the voxels it grows, so that no voxel lies between two nodes unseen, and no
/// further than that takes, as variances add: a wider one draws in what bulges, by the square
/// of its width. Of those that were tried half a spacing brings interfaces nearest to their
/// places.
inline double gaussian_width(double smooth, double spacing) noexcept {
  constexpr double kCoarse = 0.5;
  const double step = std::max(1.0, spacing), least = std::max(smooth, kLeastSmooth);
  return std::sqrt(least * least + kCoarse * kCoarse * (step * step - 1));
}

/// How far a node sees along an axis, voxels, where nodes are `spacing` apart. On a lattice
/// coarser than the voxels a kernel grows with it.
inline double kernel_reach(LabelKernel kernel, double smooth, double spacing) noexcept {
  constexpr double kCutOff = 2 / kDefaultSmooth;
  const double step = std::max(1.0, spacing);
  switch (kernel) {
    case LabelKernel::kTrilinear:
      return step;
    case LabelKernel::kQuadratic:
      return 1.5 * step;
    case LabelKernel::kGauss:
      break;
  }
  return std::max(1.0, kCutOff * gaussian_width(smooth, spacing));
}

}  // namespace tet
