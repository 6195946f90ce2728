// Filling a finest brick: the tets of its stencils.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/local_point.h"
#include "core/base/quality.h"
#include "core/lattice/background.h"
#include "core/stuffing/cell_nodes.h"
#include "core/stuffing/faces_around.h"
#include "core/stuffing/local_faces.h"
#include "core/stuffing/local_vertices.h"

namespace tet {

/// Where the boundary faces of a brick's tets are noted, region by region.
struct FacesOfBrick {
  FacesAround around;
  LocalFaces& faces;
  std::size_t first_tet = 0;  ///< of the region, within the brick
};

/// A finest brick that is to be filled, as one region sees it.
struct FinestBrick {
  const CellNodes& nodes;
  const LocalVertices& vertices;
  const StuffingRules& rules;
  Statistics statistics;
  const FacesOfBrick* faces = nullptr;  ///< null where none are wanted
};

/// Tets of one region of a brick that are no BCC tets: nodes moved, or were cut away.
class StuffedTets {
 public:
  void clear() noexcept { count_ = 0; }
  void add(const LocalTet& tet) noexcept { tet_[count_++] = tet; }
  std::span<const LocalTet> from(std::size_t first) const noexcept {
    return std::span(tet_).first(count_).subspan(first);
  }
  std::size_t count() const noexcept { return count_; }

 private:
  /// Every tet of a brick may be cut, and have a fan.
  static constexpr std::size_t kMax = std::size_t{kBrickCells} * kTetShapes * 6;
  std::size_t count_ = 0;
  std::array<LocalTet, kMax> tet_;
};

/// Writes a brick's tets of one region, four ids each; returns the end of those. Up to `end`,
/// where the last region's end, more may be overwritten. To be measured, tets that are no
/// background tets are also put into `stuffed`, and the others are counted in `counts`.
template <class Index>
Index* fill_finest(const FinestBrick& brick,
                   const SlotIds<Index>& ids,
                   Index* tets,
                   const Index* end,
                   StuffedTets& stuffed,
                   BackgroundCounts& counts) noexcept;

}  // namespace tet
