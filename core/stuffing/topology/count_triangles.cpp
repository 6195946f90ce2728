#include "core/stuffing/topology/count_triangles.h"

#include <array>
#include <cstddef>

#include "core/base/vector_clones.h"
#include "core/lattice/background.h"
#include "core/stuffing/count_tets.h"

namespace tet {
namespace {

/// The nodes around a cell's upper face across an axis, and those behind the faces that a
/// centre and an edge of it make.
struct PlacesAroundFace {
  std::array<NodePlace, 2> centre;
  std::array<NodePlace, 4> corner;
  /// By turn: behind the face of the other centre and of the edge from that turn's corner.
  std::array<std::array<NodePlace, 4>, 2> behind;
};

constexpr std::array<PlacesAroundFace, 3> kPlacesAroundFace = [] {
  std::array<PlacesAroundFace, 3> faces{};
  for (int axis = 0; axis < 3; ++axis) {
    PlacesAroundFace& face = faces[static_cast<std::size_t>(axis)];
    face.centre = {NodePlace(kCentre, {0, 0, 0}), NodePlace(kCentre, face_step(axis))};
    for (std::size_t turn = 0; turn < 4; ++turn) {
      face.corner[turn] = NodePlace(kCorner, face_turn(axis, static_cast<int>(turn)));
      const std::size_t number = static_cast<std::size_t>(axis) * 4 + turn;
      for (std::size_t i = 0; i < 4; ++i) {
        const std::uint8_t centre = kTetShape[number].face_node[i];
        if (centre > 1) continue;
        const Cell at(halo_index(0, 0, 0) + kMirrored[number][i]);
        face.behind[centre][turn] = NodePlace(kCentre, {at.x, at.y, at.z});
      }
    }
  }
  return faces;
}();

/// Numbers of triangles, one a cell, by their binary digits: 12 tets have two at most.
class TriangleCounts {
 public:
  /// Adds one to the cells of `ones` and two to those of `twos`.
  [[gnu::always_inline]] void add(const CellBits& ones, const CellBits& twos) noexcept {
    const CellBits carry = digit_[0] & ones, sum = digit_[1] ^ twos;
    const CellBits fours = (digit_[1] & twos) | (sum & carry);
    const CellBits eights = digit_[2] & fours, sixteens = digit_[3] & eights;
    digit_[0] ^= ones;
    digit_[1] = sum ^ carry;
    digit_[2] ^= fours;
    digit_[3] ^= eights;
    digit_[4] ^= sixteens;
  }
  using Digits = std::array<BrickMask, 5>;
  [[gnu::always_inline]] void store(Digits& digits) const noexcept {
    for (std::size_t d = 0; d < digits.size(); ++d) store_bits(digit_[d], digits[d]);
  }

 private:
  std::array<CellBits, 5> digit_{};
};

/// The signs of a node near each cell.
struct NodeBits {
  CellBits plus, zero;

  [[gnu::always_inline]] NodeBits(const NodesNear& nodes, const NodePlace& place) noexcept {
    load_bits(place.in(nodes.plus), plus);
    load_bits(place.in(nodes.zero), zero);
  }
};

/// Adds the triangles in the four tets around the upper faces across an axis.
template <std::size_t axis>
[[gnu::always_inline]] inline void add_around_faces(const NodesNear& nodes,
                                                    TriangleCounts& counts) noexcept {
  constexpr PlacesAroundFace kFace = kPlacesAroundFace[axis];
  const NodeBits a(nodes, kFace.centre[0]), b(nodes, kFace.centre[1]);
  const std::array<NodeBits, 4> corner{
      NodeBits(nodes, kFace.corner[0]), NodeBits(nodes, kFace.corner[1]),
      NodeBits(nodes, kFace.corner[2]), NodeBits(nodes, kFace.corner[3])};
  const CellBits any_centre = a.plus | b.plus, both_centres = a.plus & b.plus;
  const CellBits one_centre = a.plus ^ b.plus;
  const CellBits zero_centre = a.zero | b.zero, zero_centres = a.zero & b.zero;
  const CellBits no_minus_centre = (a.plus | a.zero) & (b.plus | b.zero);
  const CellBits plus_and_zero = a.plus & b.zero, zero_and_plus = a.zero & b.plus;
#pragma GCC unroll 4
  for (std::size_t turn = 0; turn < 4; ++turn) {
    // The edge's corners, and then the other two.
    const NodeBits &k = corner[turn], &l = corner[(turn + 1) % 4];
    const NodeBits &m = corner[(turn + 2) % 4], &n = corner[(turn + 3) % 4];
    const CellBits any_corner = k.plus | l.plus;
    const CellBits no_minus = no_minus_centre & (k.plus | k.zero) & (l.plus | l.zero);
    const CellBits cut = (any_centre | any_corner) & ~no_minus;
    const CellBits two = (one_centre & (k.plus ^ l.plus)) | (both_centres & ~any_corner) |
                         (k.plus & l.plus & ~any_centre);
    const CellBits quad = two & ~(zero_centre | k.zero | l.zero);  // ++--
    // `+000`, where no `+` is behind the zeros.
    CellBits behind_a, behind_b;
    load_bits(kFace.behind[0][turn].in(nodes.plus), behind_a);
    load_bits(kFace.behind[1][turn].in(nodes.plus), behind_b);
    const CellBits plus_centre =
        k.zero & l.zero & ((plus_and_zero & ~behind_a) | (zero_and_plus & ~behind_b));
    const CellBits plus_corner =
        zero_centres & ((k.plus & l.zero & ~m.plus) | (l.plus & k.zero & ~n.plus));
    counts.add((cut & ~quad) | plus_centre | plus_corner, quad);
  }
}

TET_VECTOR_CLONES
void count_in_cells(const NodesNear& nodes, TriangleCounts::Digits& digits) noexcept {
  TriangleCounts counts;
  add_around_faces<0>(nodes, counts);
  add_around_faces<1>(nodes, counts);
  add_around_faces<2>(nodes, counts);
  counts.store(digits);
}

}  // namespace

std::uint64_t count_triangles(const NodesNear& nodes) noexcept {
  TriangleCounts::Digits digits;
  count_in_cells(nodes, digits);
  std::uint64_t count = 0;
  for (std::size_t d = 0; d < digits.size(); ++d)
    count += std::uint64_t{digits[d].count()} << d;
  return count;
}

}  // namespace tet
