#include "core/stuffing/thin_walls.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>

#include "core/base/vec3.h"
#include "core/base/vector_clones.h"
#include "core/field/cell_signs.h"

namespace tet {
namespace {

/// How squarely a lattice line has to meet both sides of a wall: the cosine of its angle with
/// the surface's normal. Every plane has a lattice line with 0.816 or more, so every wall is
/// seen; a corner of 90 degrees is met with 0.707 at most, so edges of thick solids are not.
constexpr double kFacing = 0.75;

constexpr float edge_length(int direction) noexcept {
  return is_long(direction) ? kLongLength : kShortLength;
}

/// A vector in the lattice's axes, of any length.
using LatticeVector = BasicVector<float>;

LatticeVector to_vector(LatticeCoord v) noexcept {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

/// In double, as squares of the largest phi leave the range of a float.
double wide_dot(const LatticeVector& a, const LatticeVector& b) noexcept {
  return dot(widened(a), widened(b));
}

/// True when `gradient` points along `along`, within the angle of kFacing.
bool faces(const LatticeVector& gradient, const LatticeVector& along) noexcept {
  const double product = wide_dot(gradient, along);
  return product > 0 && product * product >= kFacing * kFacing * wide_dot(gradient, gradient) *
                                                 wide_dot(along, along);
}

/// phi's gradient at a node from its 14 neighbours, which weigh every direction alike.
LatticeVector gradient_at(const BrickSamples& samples, NodeKind kind, int node) noexcept {
  LatticeVector sum{};
  for (int d = 0; d < kDirections; ++d) {
    const auto& column = end_kind(kind, d) == kCorner ? samples.corner : samples.centre;
    const float phi = column[static_cast<std::size_t>(node + end_offset(kind, d))];
    const LatticeVector step = to_vector(kDirection[static_cast<std::size_t>(d)]);
    sum = {sum.x + phi * step.x, sum.y + phi * step.y, sum.z + phi * step.z};
  }
  return sum;
}

/// Shortest chord through each node along the lattice lines seen so far.
using Chords = std::array<float, kHaloNodes>;

/// Words of a set that hold the brick's own nodes.
constexpr std::size_t kFirstOwnWord = halo_index(0, -2, -2) / 64;
constexpr std::size_t kEndOwnWord = halo_index(kBrickEdge, -2, -2) / 64;

/// Whether any of the brick's own nodes lies between two cut points on a line through it. None
/// does in most bricks, so this is all that they cost.
TET_VECTOR_CLONES
bool any_between_cuts(const EdgeSets& cut) noexcept {
  HaloSet between;
  for (std::size_t family = 0; family < kEdgeFamilies; ++family) {
    const NodeKind kind = family_kind(static_cast<int>(family));
    const int direction = family_direction(static_cast<int>(family));
    const int back = end_offset(kind, opposite(direction));
    const auto behind =
        static_cast<std::size_t>(edge_family(end_kind(kind, direction), direction));
    for (std::size_t w = kFirstOwnWord; w < kEndOwnWord; ++w) {
      between.word[w] |= cut[family].word[w] & word_seen_from(cut[behind], w, back);
    }
  }
  return (between & kOwnNodes).any();
}

/// Calls `visit(node)` for the brick's nodes between two cut points on the line through them in
/// an owned direction.
template <class Visit>
void for_each_between_cuts(const CutPoints& cuts,
                           NodeKind kind,
                           int direction,
                           const Visit& visit) {
  const NodeKind end = end_kind(kind, direction);
  const HaloSet& ahead = cuts.cut[static_cast<std::size_t>(edge_family(kind, direction))];
  const HaloSet& behind = cuts.cut[static_cast<std::size_t>(edge_family(end, direction))];
  for_each_bit(brick_part(ahead) & brick_part(behind, end_step(kind, opposite(direction))),
               [&](int x, int y, int z) { visit(halo_index(x, y, z)); });
}

/// Notes the nodes of one kind that lines in one direction find in a thin wall.
void find_along(const BrickSamples& samples,
                const CutPoints& cuts,
                NodeKind kind,
                int direction,
                HaloSet& thin,
                Chords& chords) noexcept {
  const NodeKind end = end_kind(kind, direction);
  const int ahead = end_offset(kind, direction), behind = end_offset(kind, opposite(direction));
  const auto& fraction_ahead =
      cuts.fraction[static_cast<std::size_t>(edge_family(kind, direction))];
  const auto& fraction_behind =
      cuts.fraction[static_cast<std::size_t>(edge_family(end, direction))];
  for_each_between_cuts(cuts, kind, direction, [&](int node) {
    const auto i = static_cast<std::size_t>(node);
    const float chord =
        (fraction_ahead[i] + 1 - fraction_behind[static_cast<std::size_t>(node + behind)]) *
        edge_length(direction);
    if (chord >= kResolvedChord || (thin.test(node) && chord >= chords[i])) return;
    // Away from the node: phi grows where the node is inside, and falls where it is outside.
    const bool inside = cuts.signs.inside[kind].test(node);
    const int away = inside ? direction : opposite(direction);
    const LatticeVector forward = to_vector(kDirection[static_cast<std::size_t>(away)]);
    const LatticeVector backward =
        to_vector(kDirection[static_cast<std::size_t>(opposite(away))]);
    if (!faces(gradient_at(samples, end, node + ahead), forward) ||
        !faces(gradient_at(samples, end, node + behind), backward)) {
      return;
    }
    thin.set(node);
    chords[i] = chord;
  });
}

/// phi along one lattice edge, by lattice coordinates.
class EdgeProbe {
 public:
  EdgeProbe(PhiSampler& sampler, BrickCoord brick, LatticeCoord low, int direction) noexcept
      : sampler_(sampler),
        origin_{8.0 * brick.x + 0.5 * low.x, 8.0 * brick.y + 0.5 * low.y,
                8.0 * brick.z + 0.5 * low.z},
        along_(to_vector(kDirection[static_cast<std::size_t>(direction)])) {}

  float at(float t) noexcept { return moved(t, 0, 0, 0); }

  /// True when the surface at `t` faces the edge's upper end (`up`) or its lower one.
  bool faces_end(float t, bool up) noexcept {
    const double step = 0.5 / sampler_.field().spacing_voxels;  // half a voxel
    const LatticeVector gradient{moved(t, step, 0, 0) - moved(t, -step, 0, 0),
                                 moved(t, 0, step, 0) - moved(t, 0, -step, 0),
                                 moved(t, 0, 0, step) - moved(t, 0, 0, -step)};
    return faces(gradient, up ? along_ : LatticeVector{-along_.x, -along_.y, -along_.z});
  }

 private:
  float moved(float t, double x, double y, double z) noexcept {
    const auto half = [&](float along) { return 0.5 * static_cast<double>(t * along); };
    return sampler_.at(origin_.x + half(along_.x) + x, origin_.y + half(along_.y) + y,
                       origin_.z + half(along_.z) + z);
  }

  PhiSampler& sampler_;
  struct {
    double x, y, z;
  } origin_;
  LatticeVector along_;
};

/// The shortest piece of an edge between two changes of sign.
struct Piece {
  float begin = 0, end = 2;  // longer than any edge
  bool inside = false;

  bool found() const noexcept { return end <= 1; }
};

/// Looks at `pieces` + 1 points of an edge, its ends (whose phi is known) among them.
Piece shortest_piece(EdgeProbe& probe, float low, float high, int pieces) noexcept {
  Piece shortest;
  float previous = low, last_change = -1;
  for (int i = 1; i <= pieces; ++i) {
    const float step = 1 / static_cast<float>(pieces);
    const float phi = i == pieces ? high : probe.at(static_cast<float>(i) * step);
    if ((phi < 0) != (previous < 0)) {
      const float change = (static_cast<float>(i - 1) + previous / (previous - phi)) * step;
      if (last_change >= 0 && change - last_change < shortest.end - shortest.begin) {
        shortest = {last_change, change, previous < 0};
      }
      last_change = change;
    }
    previous = phi;
  }
  return shortest;
}

/// An edge of the lattice, by its lower node.
struct LatticeEdge {
  NodeKind kind;
  int low;  // halo index
  int direction;
};

constexpr int kMaxPieces = 16;

void probe_edge(const BrickSamples& samples,
                PhiSampler& sampler,
                BrickCoord brick,
                const LatticeEdge& edge,
                ThinSpots& spots) noexcept {
  const auto [kind, node, direction] = edge;
  const float length = edge_length(direction);
  const double voxels = static_cast<double>(length) * sampler.field().spacing_voxels;
  const int pieces = static_cast<int>(std::clamp(std::ceil(voxels), 2.0, 1.0 * kMaxPieces));
  const auto phi_at = [&](NodeKind of, int index) {
    const auto& column = of == kCorner ? samples.corner : samples.centre;
    return column[static_cast<std::size_t>(index)];
  };
  EdgeProbe probe(sampler, brick, node_coord(kind, node), direction);
  const Piece piece = shortest_piece(
      probe, phi_at(kind, node),
      phi_at(end_kind(kind, direction), node + end_offset(kind, direction)), pieces);
  if (!piece.found() || !probe.faces_end(piece.begin, !piece.inside) ||
      !probe.faces_end(piece.end, piece.inside)) {
    return;
  }
  spots.add(node_coord(kind, node), piece.inside, (piece.end - piece.begin) * length);
}

}  // namespace

void ThinSpots::add(LatticeCoord node, bool is_inside, float chord) noexcept {
  ++(is_inside ? inside : outside);
  min = {std::min(min.x, node.x), std::min(min.y, node.y), std::min(min.z, node.z)};
  max = {std::max(max.x, node.x), std::max(max.y, node.y), std::max(max.z, node.z)};
  const int bin = static_cast<int>(chord * kBinsPerSpacing);
  ++chords[static_cast<std::size_t>(std::clamp(bin, 0, kBins - 1))];
}

void find_thin_nodes(const BrickSamples& samples,
                     const CutPoints& cuts,
                     ThinSpots& spots) noexcept {
  if (!any_between_cuts(cuts.cut)) return;
  for (const NodeKind kind : {kCorner, kCentre}) {
    HaloSet thin;
    Chords chords;
    for (int d = 0; d < kOwnedDirections; ++d) find_along(samples, cuts, kind, d, thin, chords);
    for_each_bit(thin, [&](int node) {
      spots.add(node_coord(kind, node), cuts.signs.inside[kind].test(node),
                chords[static_cast<std::size_t>(node)]);
    });
  }
}

void find_thin_edges(const BrickSamples& samples,
                     PhiSampler& sampler,
                     BrickCoord brick,
                     ThinSpots& spots) {
  const BrickMask cells = cells_with_both_signs(sampler.field(), brick);
  const auto probe = [&](NodeKind kind, int node, int direction) {
    probe_edge(samples, sampler, brick, {kind, node, direction}, spots);
  };
  // Each edge once: a cell has those in it, and the long ones from its centre and lowest
  // corner.
  for_each_bit(cells, [&](int x, int y, int z) {
    const int cell = halo_index(x, y, z);
    for (int d = 0; d < kOwnedDirections; ++d) {
      probe(kCentre, cell, d);
      if (is_long(d)) {
        probe(kCorner, cell, d);
      } else {
        probe(kCorner, cell + end_offset(kCentre, opposite(d)), d);
      }
    }
  });
}

}  // namespace tet
