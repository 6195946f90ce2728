// Shapes of tets beside their dihedral angles: three ratios that are 1 for the regular tet, and
// lengths of edges.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/types.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// What one tet is like. docs/report.md has the formulas.
struct ShapeRatios {
  double scaled_jacobian = 0;  ///< in [-1, 1]; not above 0 where the tet is not positive
  double radius_ratio = 0;     ///< three times the inner radius to the outer one, in [0, 1]
  double edge_ratio = 0;       ///< the shortest edge to the longest, in [0, 1]
  std::array<double, 6> edges{};
};

/// `place` has the corners. A tet without an edge has 0 everywhere.
ShapeRatios shape_of(const std::array<WorldPoint, 4>& place) noexcept;

/// Values of a ratio by fiftieths of [0, 1]; what is below counts in the first bin.
struct RatioStats {
  static constexpr std::size_t kBins = 50;
  /// Small beside what a mean is told with, and large enough for 2^33 ratios.
  static constexpr double kUnit = 0x1p-30;
  double min = 1, max = -1;
  /// Sums all ratios, each rounded to a multiple of kUnit: it is the same in any order.
  std::int64_t sum_units = 0;
  std::uint64_t count = 0;
  std::array<std::uint64_t, kBins> histogram{};

  double mean() const noexcept {
    if (count == 0) return 0;
    return kUnit * static_cast<double>(sum_units) / static_cast<double>(count);
  }
  void add(double ratio) noexcept;
  void add(const RatioStats& other) noexcept;
};

/// Lengths by quarters of an octave, in spacings: bin b counts those from 2^(b/4 - 4) on, less
/// than the next bin's; the first and the last also what is beyond them.
struct LengthStats {
  static constexpr std::size_t kBins = 64;
  static constexpr int kBinsPerOctave = 4, kFirstOctave = -4;
  double min = 0, max = 0;  ///< world units
  std::array<std::uint64_t, kBins> histogram{};

  void add(double length, double spacing) noexcept;
  void add(const LengthStats& other) noexcept;

 private:
  bool empty_ = true;
};

/// One of the worst tets of a mesh, and where it is.
struct WorstTet {
  std::uint64_t tet = 0;
  ShapeRatios shape;
  WorldPoint at;  ///< the mean of its corners
};

/// What is told of some tets does not depend on the order in which they are added.
struct ShapeStats {
  static constexpr std::size_t kWorst = 16;
  RatioStats scaled_jacobian, radius_ratio, edge_ratio;
  LengthStats edges;               ///< of each tet's edges, six a tet
  std::uint64_t not_positive = 0;  ///< tets whose volume is zero or less
  /// Those with the smallest scaled Jacobian, the worst first; at most kWorst.
  std::vector<WorstTet> worst;

  /// Adds tet number `tet` of a mesh, whose corners are stored at `place`.
  void add(std::uint64_t tet, const std::array<WorldPoint, 4>& place, const MeshHeader& header);
  void add(const ShapeStats& other);
};

/// Measures every tet in parallel; one value for any number of threads.
ShapeStats measure_shapes(const TetMesh& mesh);

}  // namespace tet
