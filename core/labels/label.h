// What a node of the lattice, or a tet, is a part of.
#pragma once

#include <cstdint>

namespace tet {

/// The number of a label; less than `kJoker`.
using Label = std::uint16_t;

/// Stands for a node that moved: it lies on the interfaces of its own label and of all those
/// around it.
inline constexpr Label kJoker = 0xffff;

/// Which labels are meshed: all but one, or all.
struct KeptLabels {
  Label left_out = kJoker;  ///< the background; kJoker: none

  bool all() const noexcept { return left_out == kJoker; }
  bool holds(Label label) const noexcept { return label != left_out; }
};

}  // namespace tet
