// What has to be bounded: tets whose corners slide along edges of the lattice.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tet::certificate {

/// One lattice tet has no more than four nodes that moved, or six cut points.
inline constexpr std::size_t kParameters = 6;

/// A point, or the displacement of one, in twelfths of the doubled lattice coordinates: the
/// mean of three or of four cut points has whole ones too. The lattice's spacing is 24.
using Place = std::array<int, 3>;
inline constexpr int kUnit = 12;
inline constexpr double kSpacing = 2.0 * kUnit;

/// A corner of a tet: base + sum over k of t_k * along_k.
struct Corner {
  Place base{};
  std::array<Place, kParameters> along{};
  friend auto operator<=>(const Corner&, const Corner&) = default;
};

/// Four corners; positive for at least one choice of the parameters, and the proof is that it
/// is for all.
using Tet = std::array<Corner, 4>;

/// How far a parameter goes: a node's warp, or the length of a column, in units of its edge.
struct Range {
  double low = 0, high = 0;
  friend auto operator<=>(const Range&, const Range&) = default;
};

/// What a parameter moves: a warped node or a cut point, from `base` along an edge.
struct Slide {
  Place base{}, along{};
  Range range;
  friend auto operator<=>(const Slide&, const Slide&) = default;
};

/// t_longer >= t_shorter, but for `kTieSlack`.
struct ColumnOrder {
  std::uint8_t longer = 0, shorter = 0;
  friend auto operator<=>(const ColumnOrder&, const ColumnOrder&) = default;
};

/// Column lengths are compared as floats in [0, 1], one of each pair perhaps rounded: 1 -
/// fraction. Rounding never reverses an order, but it may make a tie of two lengths that are
/// 2^-25 apart; and an order may follow from up to three such comparisons.
inline constexpr double kTieSlack = 0x1p-23;

/// How far float32 may move a vertex, in spacings: its position is off by at most 2^-24 of its
/// size along each axis, and it lies within 4096 spacings of the origin along each axis of the
/// lattice. The rest is ample for the rounding of what was computed in double.
inline constexpr double kStoredDisplacement = 0x1p-12 * 1.7320508075688774 * (1 + 0x1p-16);

/// Tets that may be emitted together, for some range of the parameters.
///
/// `tets` have their angles bounded. With a `rival`, they stand only where the worst angle of
/// `contender` (as core/stuffing/surface_diagonal measures it) is not worse than that of
/// `rival`.
struct Problem {
  std::string name;
  std::size_t parameter_count = 0;
  std::array<Slide, kParameters> slide{};
  std::vector<ColumnOrder> orders;
  std::vector<Tet> tets, contender, rival;
};

}  // namespace tet::certificate
