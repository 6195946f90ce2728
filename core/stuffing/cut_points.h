// Where the surface crosses the lattice edges of one brick.
#pragma once

#include <array>
#include <cstddef>

#include "core/base/brick_mask.h"
#include "core/base/types.h"
#include "core/lattice/bcc.h"
#include "core/stuffing/cut_edges.h"
#include "core/stuffing/node_signs.h"

namespace tet {

class PhiSampler;
struct BrickSamples;

/// Where the edges of a brick and its halo are cut, by family and lower node. Those of a node
/// lie side by side, as the surface mostly crosses several of its edges.
class CutFractions {
 public:
  /// Those of one family.
  template <class Fraction>
  class OfFamily {
   public:
    explicit OfFamily(Fraction* first) noexcept : first_(first) {}
    Fraction& operator[](std::size_t low) const noexcept { return first_[low * kPerNode]; }

   private:
    Fraction* first_;
  };

  OfFamily<float> operator[](std::size_t family) noexcept {
    return OfFamily<float>(&fraction_[first_of(family)]);
  }
  OfFamily<const float> operator[](std::size_t family) const noexcept {
    return OfFamily<const float>(&fraction_[first_of(family)]);
  }

 private:
  static constexpr std::size_t kPerNode = 8;  ///< one more than there are: half a cache line
  static constexpr std::size_t first_of(std::size_t family) noexcept {
    constexpr std::size_t kOfKind = kHaloNodes * kPerNode;
    return family / kOwnedDirections * kOfKind + family % kOwnedDirections;
  }

  alignas(64) std::array<float, kNodeKinds * kHaloNodes * kPerNode> fraction_;
};

/// Cut points of every edge with an end among the nodes in [kNodeMin, kNodeMax]^3.
///
/// `fraction[family]` is valid where `cut[family]` has a bit: it runs from the lower node
/// (whose halo index this is) along the edge, in [0, 1]. Error: of a volume, two bracketed
/// secant steps on the trilinear field behind the linear guess, which alone is off by O(h^2);
/// of a scene see scene_zeros.h. Source: Labelle & Shewchuk 2007, section 3.
struct CutPoints {
  NodeSigns signs;
  EdgeSets cut;
  CutEdges edges;  ///< the same, as columns
  CutFractions fraction;
};

/// Finds the cut points between nodes whose signs are known; `sampler` answers for the true
/// field between lattice nodes.
void find_cut_points(const BrickSamples& samples,
                     PhiSampler& sampler,
                     BrickCoord brick,
                     CutPoints& cuts) noexcept;

}  // namespace tet
