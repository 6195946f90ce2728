// The background tets of a graded tree that have a node inside, as columns.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/cancel.h"
#include "core/field/phi_field.h"
#include "core/graded/cut_box.h"
#include "core/graded/graded_tree.h"
#include "core/lattice/bcc.h"

namespace tet {

using NodeId = std::uint32_t;

/// What a node of a background is.
enum class BackgroundNode : std::uint8_t {
  kCorner,     ///< of a leaf
  kCentre,     ///< of a leaf
  kCutMiddle,  ///< of a leaf's face that lies in a face of the box
};

/// A conforming mesh of tets, uncut: nodes by number, and tets of four nodes each, positive.
struct BackgroundMesh {
  std::optional<CutBox> box;       ///< that it ends at
  std::vector<LatticeCoord> node;  ///< where it lies: doubled finest spacings
  std::vector<BackgroundNode> kind;
  std::vector<std::uint8_t> level;  ///< of the smallest leaf that it is a corner or centre of
  std::vector<float> phi;
  std::vector<NodeId> tets;

  std::size_t tet_count() const noexcept { return tets.size() / 4; }
  CutFaces faces_at(NodeId id) const noexcept {
    return box ? box->faces_at(node[id]) : CutFaces{0};
  }
};

/// Memory for a background of so many nodes and tets, bytes.
std::uint64_t background_bytes(std::uint64_t nodes, std::uint64_t tets) noexcept;

/// Samples phi at every node, and keeps the tets with a node inside. The tree has fewer than
/// 2^32 nodes. Parallel. If cancelled, discard the result.
BackgroundMesh make_background(const GradedTree& graded,
                               const PhiField& field,
                               const Cancellation& cancellation);

}  // namespace tet
