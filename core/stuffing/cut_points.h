// Where the surface crosses the lattice edges of one brick.
#pragma once

#include <array>

#include "core/base/brick_mask.h"
#include "core/base/types.h"
#include "core/lattice/bcc.h"
#include "core/stuffing/cut_edges.h"
#include "core/stuffing/node_signs.h"

namespace tet {

class PhiSampler;
struct BrickSamples;

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
  std::array<std::array<float, kHaloNodes>, kEdgeFamilies> fraction;
};

/// Finds the cut points between nodes whose signs are known; `sampler` answers for the true
/// field between lattice nodes.
void find_cut_points(const BrickSamples& samples,
                     PhiSampler& sampler,
                     BrickCoord brick,
                     CutPoints& cuts) noexcept;

}  // namespace tet
