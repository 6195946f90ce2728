// One lattice tet whose nodes have several labels, or moved: which tets stand for it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/types.h"
#include "core/labels/face_point.h"
#include "core/labels/label.h"
#include "core/labels/label_cost.h"
#include "core/labels/lattice_faces.h"
#include "core/lattice/bcc.h"
#include "core/stuffing/column_rule.h"

namespace tet {

/// A corner of one of those tets: 0..3 is a node of the lattice tet, 4 + e the cut point on its
/// edge e, 10 + i the triple point of its face opposite to node i, then the tet's own middle.
using LabelCorner = std::uint8_t;
constexpr LabelCorner label_cut(std::size_t a, std::size_t b) {
  return static_cast<LabelCorner>(4 + edge_between(a, b));
}
constexpr LabelCorner label_triple(std::size_t opposite_node) {
  return static_cast<LabelCorner>(10 + opposite_node);
}
inline constexpr LabelCorner kLabelMiddle = 14;
inline constexpr std::size_t kLabelCorners = 15;
using LabelTetCorners = std::array<LabelCorner, 4>;

/// Where the middle of a tet lies, if it has one: amid the four cut points of two labels' quad,
/// or on the way from the mean of its nodes to that of its triple points, two or four of them.
enum class LabelMiddle : std::uint8_t {
  kNone,
  kOfCuts,
  kOfNodes,
  kQuarter,
  kHalfWay,
  kThreeQuarters,
  kOfTriples,
};

/// A lattice tet after the warp.
struct LabelledTet {
  const TetShape& shape;
  std::array<Label, 4> label{};  ///< of its nodes; kJoker where a node moved
  EdgeFractions fraction{};      ///< on edges between two labels: from the lower node
  /// On faces of three labels, by the node opposite to them.
  std::array<FacePoint, kTetFaces> triple{};
  /// What was found of its middle when it was divided before.
  std::optional<LabelMiddle> decided{};
};

/// What each node of a tet votes for where all four moved: its own label, and that at the other
/// end of the edge that it moved along.
using JokerVotes = std::array<std::array<Label, 2>, 4>;

/// The tets that stand for a lattice tet, each with its label; positive when the nodes 0..3 of
/// the lattice tet are.
struct LabelDivision {
  static constexpr std::size_t kMax = 24;

  std::size_t count = 0;
  std::array<LabelTetCorners, kMax> tet;
  std::array<Label, kMax> label;
  LabelMiddle middle = LabelMiddle::kNone;

  void add(const LabelTetCorners& corners, Label of) noexcept {
    tet[count] = corners;
    label[count++] = of;
  }
};

/// Most votes win; where they are equal, the highest label.
Label elected(const JokerVotes& votes) noexcept;

/// Divides a tet. A division of three or four labels is taken if all its tets are good
/// (label_cost.h): of three labels the best of the twelve tets that need no middle; else those
/// around the middle that is nearest to the triple points. If none is good the middle is the
/// mean of the nodes, around which every angle keeps the bounds of both sides. `votes` are
/// looked at only where all its nodes moved.
void divide(const LabelledTet& tet, const JokerVotes& votes, LabelDivision& out) noexcept;

/// Where a tet's cut points, triple points and middle lie: in spacings from the corner that
/// `cell`, doubled, is away from the tet's cell. Nodes are where the lattice has them, so no
/// joker's place is told.
class LabelPlaces {
 public:
  LabelPlaces(const LabelledTet& tet, LatticeCoord cell) noexcept : tet_(tet), cell_(cell) {}

  WorldPoint node(std::size_t i) const noexcept;
  WorldPoint cut(std::size_t edge) const noexcept;
  WorldPoint triple(std::size_t opposite_node) const noexcept;
  WorldPoint middle(LabelMiddle of) const noexcept;

 private:
  LatticeCoord node_at(std::size_t i) const noexcept;
  bool is_cut(std::size_t edge) const noexcept;
  bool is_triple(std::size_t opposite_node) const noexcept;

  const LabelledTet& tet_;
  LatticeCoord cell_;
};

}  // namespace tet
