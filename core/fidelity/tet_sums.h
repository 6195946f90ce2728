// What is summed over a mesh's tets, in whichever order they come.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/types.h"
#include "core/mesh/tet_mesh.h"
#include "core/mesh/tet_shapes.h"

namespace tet {

/// A sum that does not depend on the order of what is added: all is rounded to whole units.
class WholeSum {
 public:
  WholeSum() = default;
  /// No sum is larger than `most`, or if it is, it means nothing.
  explicit WholeSum(double most) noexcept;

  void add(double value) noexcept;
  void add(const WholeSum& other) noexcept { units_ += other.units_; }
  double value() const noexcept;

 private:
  double unit_ = 1;
  std::uint64_t units_ = 0;  ///< two's complement: it may go round, and nothing is undefined
};

/// Volumes and shapes of a mesh's tets. Not thread-safe: one per task, added up in the end.
class TetSums {
 public:
  /// The header outlives this.
  explicit TetSums(const MeshHeader& header);

  /// Adds tet number `tet`, whose corners are stored at `place`.
  void add(std::uint64_t tet, const std::array<WorldPoint, 4>& place, MeshRegion region);
  void add(const TetSums& other);

  /// Tells the volume of the tets inside, or of several parts that of each.
  std::vector<double> volumes() const;
  const ShapeStats& shapes() const noexcept { return shapes_; }

 private:
  std::size_t part_of(std::uint64_t tet) noexcept;

  const MeshHeader* header_;
  std::vector<WholeSum> six_volumes_;
  ShapeStats shapes_;
  std::size_t part_ = 0;  ///< that the last tet was of
};

}  // namespace tet
