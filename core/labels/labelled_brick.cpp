#include "core/labels/labelled_brick.h"

#include <algorithm>
#include <cstddef>

#include "core/base/heap_bytes.h"
#include "core/labels/label_tets.h"
#include "core/lattice/background.h"
#include "core/octree/octree.h"
#include "core/stuffing/brick_geometry.h"
#include "core/stuffing/stuffed_brick.h"

namespace tet {
namespace {

bool holds(const BrickBox& box, BrickCoord b) noexcept {
  return b.x >= box.min.x && b.x <= box.max.x && b.y >= box.min.y && b.y <= box.max.y &&
         b.z >= box.min.z && b.z <= box.max.z;
}

/// Cells of a brick and its halo that a domain holds.
HaloSet cells_of_domain(const BrickBox& domain, BrickCoord brick) noexcept {
  HaloSet cells;
  for_each_brick({{-1, -1, -1}, {1, 1, 1}}, [&](BrickCoord o) {
    if (!holds(domain, {brick.x + o.x, brick.y + o.y, brick.z + o.z})) return;
    add_brick(cells, BrickMask::all(), o.x, o.y, o.z);
  });
  return cells;
}

bool any_of(const EdgeSets& sets) noexcept {
  return std::ranges::any_of(sets, [](const HaloSet& set) { return set.any(); });
}

/// Nodes with a label that is meshed.
HaloSet kept_nodes(const WarpedLabels& warped, NodeKind kind, const KeptLabels& kept) noexcept {
  HaloSet nodes = kKnownNodes - warped.joker[kind];
  if (kept.all()) return nodes;
  for_each_bit(nodes, [&](int node) {
    if (kept.holds(warped.label[kind][static_cast<std::size_t>(node)])) return;
    nodes.word[static_cast<std::size_t>(node >> 6)] &= ~(std::uint64_t{1} << (node & 63));
  });
  return nodes;
}

/// Looks at the tets around one brick.
class BrickSurvey {
 public:
  BrickSurvey(BrickCoord brick, const LabelRules& rules, const LabelWorkspace& workspace)
      : brick_(brick),
        rules_(rules),
        samples_(workspace.samples),
        warped_(workspace.warped),
        triples_(workspace.triples),
        domain_(cells_of_domain(rules.domain, brick)),
        whole_(!(kKnownNodes - domain_).any()) {
    for (const NodeKind kind : {kCorner, kCentre}) {
      kept_[kind] = kept_nodes(warped_, kind, rules.kept);
    }
    for (std::size_t shape = 0; shape < kTetShapes; ++shape) find_divided(shape);
  }

  std::unique_ptr<LabelledBrick> keep() {
    auto brick = std::make_unique<LabelledBrick>();
    keep_nodes(*brick);
    keep_cuts(*brick);
    keep_triples(*brick);
    if (!holds(rules_.domain, brick_)) return brick;
    keep_cells(*brick);
    keep_tets(*brick);
    return brick;
  }

 private:
  /// Tets of one shape whose nodes are not alike, by cell in [-1, 7]^3.
  struct Divided {
    HaloSet all;     ///< wherever they lie
    HaloSet meshed;  ///< those in the domain
  };

  HaloSet tets_of_axis(int axis) const noexcept {
    return domain_ & seen_from(domain_, face_offset(axis)) & kCellsAround;
  }

  void find_divided(std::size_t number) {
    const TetShape& shape = kTetShape[number];
    HaloSet unlike = warped_.joker[shape.kind[0]];
    for (std::size_t e = 0; e < 3; ++e) unlike |= warped_.differs[shape.edge_family[e]];
    Divided& divided = divided_[number];
    divided.all = seen_from(unlike, shape.offset[0]) & kCellsAround;
    divided.meshed = divided.all & tets_of_axis(static_cast<int>(number / 4));
  }

  Label label(NodeKind kind, int node) const noexcept {
    return warped_.label[kind][static_cast<std::size_t>(node)];
  }

  Joker joker_at(NodeKind kind, int node) const noexcept {
    const int direction = warped_.direction[kind][static_cast<std::size_t>(node)];
    const auto [family, low] = moved_along(kind, node, direction);
    const int end = node + end_offset(kind, direction);
    return {samples_.fraction[static_cast<std::size_t>(family)][static_cast<std::size_t>(low)],
            samples_.label[kind][static_cast<std::size_t>(node)],
            samples_.label[end_kind(kind, direction)][static_cast<std::size_t>(end)],
            static_cast<std::uint8_t>(direction)};
  }

  JokerVotes votes_of(const TetShape& shape, int cell) const noexcept {
    JokerVotes votes;
    for (std::size_t i = 0; i < 4; ++i) {
      const Joker joker = joker_at(shape.kind[i], cell + shape.offset[i]);
      votes[i] = {joker.own, joker.other};
    }
    return votes;
  }

  void keep_nodes(LabelledBrick& brick) const {
    const std::array<HaloSet, kNodeKinds> used = used_nodes();
    for (const NodeKind kind : {kCorner, kCentre}) {
      brick.joker[kind] = brick_part(warped_.joker[kind]);
      brick.unused[kind] = brick.joker[kind] & ~brick_part(used[kind]);
      for_each_bit(BrickMask::all(), [&](int x, int y, int z) {
        brick.label[kind][static_cast<std::size_t>((x * 8 + y) * 8 + z)] =
            label(kind, halo_index(x, y, z));
      });
      for_each_bit(brick.joker[kind], [&](int x, int y, int z) {
        brick.jokers.push_back(joker_at(kind, halo_index(x, y, z)));
      });
    }
    if (!whole_) brick.unused[kCorner] |= lost_corners();
  }

  /// Nodes of tets with a part of a meshed label.
  std::array<HaloSet, kNodeKinds> used_nodes() const {
    std::array<HaloSet, kNodeKinds> used;
    for (std::size_t number = 0; number < kTetShapes; ++number) {
      const TetShape& shape = kTetShape[number];
      HaloSet some, jokers = divided_[number].meshed;
      for (std::size_t i = 0; i < 4; ++i) {
        some |= seen_from(kept_[shape.kind[i]], shape.offset[i]);
        jokers &= seen_from(warped_.joker[shape.kind[i]], shape.offset[i]);
      }
      some &= divided_[number].meshed;
      for_each_bit(jokers, [&](int cell) {
        if (rules_.kept.holds(elected(votes_of(shape, cell)))) some.set(cell);
      });
      for (std::size_t i = 0; i < 4; ++i) {
        used[shape.kind[i]] |= seen_from(some, -shape.offset[i]);
      }
    }
    return used;
  }

  /// Corners of the domain's box: each belongs to one cell, whose half pyramids are left out
  /// where their nodes are not alike.
  BrickMask lost_corners() const {
    const BrickBox& box = rules_.domain;
    BrickMask lost;
    for (int o = 0; o < 8; ++o) {
      const bool x = (o & 4) != 0, y = (o & 2) != 0, z = (o & 1) != 0;
      const BrickCoord owner{x ? box.max.x + 1 : box.min.x, y ? box.max.y + 1 : box.min.y,
                             z ? box.max.z + 1 : box.min.z};
      if (owner != brick_) continue;
      const int cell = halo_index(x ? -1 : 0, y ? -1 : 0, z ? -1 : 0);
      const bool has_tets = pyramid_is_alike(cell, x ? 0 : 3) ||
                            pyramid_is_alike(cell, y ? 1 : 4) ||
                            pyramid_is_alike(cell, z ? 2 : 5);
      if (!has_tets) lost.set(0, 0, 0);
    }
    return lost;
  }

  bool pyramid_is_alike(int cell, int direction) const noexcept {
    const Label centre = label(kCentre, cell);
    for (int turn = 0; turn < 4; ++turn) {
      const LatticeCoord at = face_turn(direction, turn);
      if (label(kCorner, cell + offset_index(at.x, at.y, at.z)) != centre) return false;
    }
    return centre != kJoker;
  }

  void keep_cuts(LabelledBrick& brick) const {
    EdgeSets used;
    if (!whole_) {
      for (std::size_t number = 0; number < kTetShapes; ++number) {
        const TetShape& shape = kTetShape[number];
        for (std::size_t e = 0; e < kTetEdge.size(); ++e) {
          used[shape.edge_family[e]] |=
              seen_from(divided_[number].meshed, -shape.offset[kTetEdge[e][0]]);
        }
      }
    }
    for (std::size_t f = 0; f < kEdgeFamilies; ++f) {
      brick.cut[f] = brick_part(whole_ ? warped_.cut[f] : warped_.cut[f] & used[f]);
      for_each_bit(brick.cut[f], [&](int x, int y, int z) {
        brick.cut_fractions.push_back(
            samples_.fraction[f][static_cast<std::size_t>(halo_index(x, y, z))]);
      });
    }
  }

  void keep_triples(LabelledBrick& brick) const {
    std::array<HaloSet, kFaceFamilies> used;
    if (!whole_) {
      for (std::size_t number = 0; number < kTetShapes; ++number) {
        const TetShape& shape = kTetShape[number];
        for (std::size_t i = 0; i < kTetFaces; ++i) {
          used[kFaceOfShape[number][i]] |=
              seen_from(divided_[number].meshed, -shape.offset[nodes_of_face(i)[0]]);
        }
      }
    }
    auto masks = std::make_unique<TripleMasks>();
    for (std::size_t f = 0; f < kFaceFamilies; ++f) {
      const HaloSet& found = triples_.of_family(f);
      (*masks)[f] = brick_part(whole_ ? found : found & used[f]);
      for_each_bit((*masks)[f], [&](int x, int y, int z) {
        brick.triple_points.push_back(triples_.at(f, halo_index(x, y, z)));
      });
    }
    if (!brick.triple_points.empty()) brick.triple = std::move(masks);
  }

  void keep_cells(LabelledBrick& brick) const {
    for (int axis = 0; axis < 3; ++axis) {
      HaloSet faces;
      for (std::size_t turn = 0; turn < 4; ++turn) {
        faces |= divided_[static_cast<std::size_t>(axis) * 4 + turn].all;
      }
      brick.finest |= brick_part(faces) | brick_part(faces, face_step(axis + 3));
    }
    brick.finest = with_siblings(brick.finest);
  }

  void keep_tets(LabelledBrick& brick) const {
    MiddleMasks middles;
    LabelDivision division;
    bool any = false;
    for (std::size_t number = 0; number < kTetShapes; ++number) {
      const TetShape& shape = kTetShape[number];
      for_each_bit(brick_part(divided_[number].meshed), [&](int x, int y, int z) {
        const int cell = halo_index(x, y, z);
        const LabelledTet tet = tet_at(number, cell);
        const bool all_moved =
            std::ranges::all_of(tet.label, [](Label l) { return l == kJoker; });
        divide(tet, all_moved ? votes_of(shape, cell) : JokerVotes{}, division);
        for (std::size_t i = 0; i < division.count; ++i) {
          brick.divided_tets += rules_.kept.holds(division.label[i]) ? 1 : 0;
        }
        if (division.middle == LabelMiddle::kNone) return;
        middles[number].set(x, y, z);
        brick.middles.push_back(division.middle);
        any = true;
      });
    }
    if (any) brick.middle = std::make_unique<const MiddleMasks>(middles);
  }

  LabelledTet tet_at(std::size_t number, int cell) const noexcept {
    const TetShape& shape = kTetShape[number];
    LabelledTet tet{shape};
    for (std::size_t i = 0; i < 4; ++i) {
      tet.label[i] = label(shape.kind[i], cell + shape.offset[i]);
    }
    for (std::size_t e = 0; e < kTetEdge.size(); ++e) {
      const int low = cell + shape.offset[kTetEdge[e][0]];
      const std::uint8_t family = shape.edge_family[e];
      if (!warped_.cut[family].test(low)) continue;
      tet.fraction[e] = samples_.fraction[family][static_cast<std::size_t>(low)];
    }
    for (std::size_t i = 0; i < kTetFaces; ++i) {
      const int low = cell + shape.offset[nodes_of_face(i)[0]];
      const std::uint8_t family = kFaceOfShape[number][i];
      if (triples_.of_family(family).test(low)) tet.triple[i] = triples_.at(family, low);
    }
    return tet;
  }

  const BrickCoord brick_;
  const LabelRules& rules_;
  const LabelSamples& samples_;
  const WarpedLabels& warped_;
  const TriplePoints& triples_;
  const HaloSet domain_;
  const bool whole_;  // all cells [-1, 8]^3, which its nodes' edges lead to, are in the domain
  std::array<HaloSet, kNodeKinds> kept_;
  std::array<Divided, kTetShapes> divided_;
};

/// True where the brick's tets, and all that may refine its cells, see one label alone.
bool is_alike(const WarpedLabels& warped) noexcept {
  return !any_of(warped.differs) && !warped.joker[kCorner].any() &&
         !warped.joker[kCentre].any();
}

}  // namespace

std::uint64_t LabelledBrick::other_vertices() const noexcept {
  return cut_fractions.size() + triple_points.size() + middles.size();
}

std::uint64_t LabelledBrick::bytes() const noexcept {
  return sizeof(*this) + (triple != nullptr ? sizeof(*triple) : 0) +
         (middle != nullptr ? sizeof(*middle) : 0) +
         all_heap_bytes(jokers, cut_fractions, triple_points, middles);
}

FoundLabels survey_labelled_brick(LabelSampler& sampler,
                                  BrickCoord brick,
                                  const LabelRules& rules,
                                  LabelWorkspace& workspace) {
  if (const std::optional<Label> one = sampler.one_label(brick)) return {*one, nullptr};
  sampler.sample_labels(brick, workspace.samples);
  find_label_changes(workspace.samples.label, workspace.changes);
  const Label first = workspace.samples.label[kCorner][halo_index(0, 0, 0)];
  if (!any_of(workspace.changes)) return {first, nullptr};
  sampler.sample_fractions(brick, workspace.changes, workspace.samples);
  warp_labels(workspace.changes, rules.limits, workspace.samples, workspace.warped);
  if (is_alike(workspace.warped)) return {first, nullptr};
  workspace.triples.find(sampler, brick, workspace.samples, workspace.warped);
  return {first, BrickSurvey(brick, rules, workspace).keep()};
}

}  // namespace tet
