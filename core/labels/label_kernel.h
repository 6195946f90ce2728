// How far a voxel's label reaches when indicators are made.
#pragma once

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
/// Wider kernels take more voxels a node than is worth it.
inline constexpr double kMostSmooth = 4;

}  // namespace tet
