// What is kept of a brick where labels meet, between counting and filling.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/brick_box.h"
#include "core/base/brick_mask.h"
#include "core/base/types.h"
#include "core/labels/face_point.h"
#include "core/labels/label.h"
#include "core/labels/label_samples.h"
#include "core/labels/label_tets.h"
#include "core/labels/lattice_faces.h"
#include "core/labels/triple_points.h"
#include "core/labels/warp_labels.h"
#include "core/lattice/bcc.h"

namespace tet {

/// Where a joker lies, and what it votes for where all nodes of a tet moved.
struct Joker {
  float fraction;    ///< of the cut point that it moved onto, from its edge's lower node
  Label own, other;  ///< its own label, and that at the other end of the edge
  std::uint8_t direction;
};

/// Faces of three labels, by family and lowest node; tets with a middle, by shape and cell.
using TripleMasks = std::array<BrickMask, kFaceFamilies>;
using MiddleMasks = std::array<BrickMask, kTetShapes>;

/// A brick's own nodes after the warp, and its own vertices that are no nodes, as far as tets
/// use them. Columns are in the order of their masks' bits, kind after kind or family after
/// family.
struct LabelledBrick {
  std::array<std::array<Label, kBrickCells>, kNodeKinds> label;  ///< kJoker where one moved
  NodeMasks joker;
  NodeMasks unused;  ///< jokers, and corners of the domain, that no tet has
  std::array<BrickMask, kEdgeFamilies> cut;
  std::unique_ptr<const TripleMasks> triple;  ///< null: none
  std::unique_ptr<const MiddleMasks> middle;  ///< null: none

  std::vector<Joker> jokers;
  std::vector<float> cut_fractions;
  std::vector<FacePoint> triple_points;
  std::vector<LabelMiddle> middles;  ///< of tets that have one, shape after shape

  std::uint64_t divided_tets = 0;  ///< of meshed labels, in tets whose nodes are not alike
  BrickMask finest;                ///< cells that have a part in such a tet

  /// Vertices that are no nodes.
  std::uint64_t other_vertices() const noexcept;
  std::uint64_t bytes() const noexcept;
};

/// Scratch memory for one brick.
struct LabelWorkspace {
  LabelSamples samples;
  EdgeSets changes;
  WarpedLabels warped;
  TriplePoints triples;
};

/// What is meshed, and how.
struct LabelRules {
  WarpLimits limits;
  BrickBox domain;  ///< finest bricks
  KeptLabels kept;
};

/// What a brick is: of one label as far as its tets reach, or not.
struct FoundLabels {
  Label one = 0;
  std::unique_ptr<LabelledBrick> brick;  ///< null: `one` fills it
};

/// Looks at a brick of the domain or just beyond its upper faces.
FoundLabels survey_labelled_brick(LabelSampler& sampler,
                                  BrickCoord brick,
                                  const LabelRules& rules,
                                  LabelWorkspace& workspace);

}  // namespace tet
