// Least squares on a mesh: the matrix of products of its linear functions.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/cancel.h"
#include "core/remap/columns.h"
#include "core/remap/data_mesh.h"

namespace tet {

/// The tets at each point of a mesh, and what the mesh's linear functions weigh. The mesh must
/// outlive it.
class MassMatrix {
 public:
  explicit MassMatrix(const DataMesh& mesh);

  const std::vector<double>& volumes() const noexcept { return volumes_; }
  /// The integral of each point's function.
  const std::vector<double>& weights() const noexcept { return weights_; }

  /// Adds up what each tet gives its corners: `per_corner` has four rows a tet.
  Table gather(const Table& per_corner) const;

  /// Solves for every column, with conjugate gradients that are begun at `x`. Points without
  /// tets keep what they have. Parallel; one result for any number of threads.
  void solve(const Table& right, Table& x, const Cancellation& cancellation) const;

 private:
  template <class OfCorner>
  void add_corners(std::size_t point, const OfCorner& of_corner) const;
  void multiply(const Table& x, Table& y) const;
  void solve_scaled(Table& residual, Table& x, const Cancellation& cancellation) const;

  const DataMesh& mesh_;
  std::vector<double> volumes_, weights_;
  std::vector<std::uint64_t> first_;    // of each point in corners_, and one more
  std::vector<std::uint64_t> corners_;  // 4 * tet + corner
};

}  // namespace tet
