// The tets of a mesh by what they belong to: volumes, element sets, blocks, zones.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/rank_mask.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// Tets that belong together. No tet is of two groups, and none of none.
struct TetGroup {
  std::int32_t tag = 1;  ///< the tets' label: their region or part, or see tags_of_labels
  std::string name = {};
  /// The region that its tets have; if unset they are all that follow each other.
  std::optional<MeshRegion> region = {};
  std::uint64_t first_tet = 0, tets = 0;
  /// Has all tets of a mesh with labels, sorted by label: `first_tet` is then a place in there.
  std::shared_ptr<const std::vector<std::uint64_t>> order = nullptr;

  /// The tet of this number among its own, in the mesh's order; not of a region.
  std::uint64_t tet(std::uint64_t i) const noexcept {
    return order == nullptr ? first_tet + i : (*order)[first_tet + i];
  }
};

/// The numbers that labels have in files whose tags are positive integers: their values where
/// all of them are, and else their places from 1 on.
std::vector<std::int32_t> tags_of_labels(const MeshHeader& header);

/// The labels of a segmentation's mesh, or the parts of a mesh of several grids, or "inside"
/// and "outside" of one with regions, of which one may be empty, or "inside" alone; in the
/// order of their tags. Labels may be empty.
std::vector<TetGroup> tet_groups(const TetMesh& mesh);

/// Hands out the tets of a group, in the mesh's order.
class TetsOfGroup {
 public:
  TetsOfGroup(const TetMesh& mesh, const TetGroup& group)
      : mesh_(mesh), region_(group.region), next_(group.first_tet), order_(group.order) {}

  std::uint64_t next() noexcept {
    if (order_ != nullptr) return (*order_)[next_++];
    while (region_ && mesh_.region(next_) != *region_) ++next_;
    return next_++;
  }

 private:
  const TetMesh& mesh_;
  std::optional<MeshRegion> region_;
  std::uint64_t next_;
  std::shared_ptr<const std::vector<std::uint64_t>> order_;
};

/// Where tets stand once one group is written behind the other.
class GroupedOrder {
 public:
  explicit GroupedOrder(const TetMesh& mesh);

  std::uint64_t place_of(std::uint64_t tet) const noexcept {
    if (!place_.empty()) return place_[tet];
    if (inside_.empty()) return tet;
    const std::uint64_t before = inside_.rank(tet);
    return inside_.has(tet) ? before : inside_.count() + tet - before;
  }

 private:
  RankMask inside_;                   ///< empty where groups follow each other anyway
  std::vector<std::uint64_t> place_;  ///< of each tet of a mesh with labels
};

}  // namespace tet
