// All rows of a plane of nodes at once, and the edges between planes: what is done to one row
// is done to each. For node_regions.cpp and climb.cpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "core/lattice/bcc.h"
#include "core/stuffing/topology/node_regions.h"

namespace tet::internal {

/// Rows are passed by reference and always inlined: what a vector is passed in depends on the
/// processor.
using Rows = std::uint16_t __attribute__((vector_size(sizeof(NodePlane))));

[[gnu::always_inline]] inline void read(const NodePlane& plane, Rows& rows) noexcept {
  std::memcpy(&rows, plane.word.data(), sizeof(rows));
}
[[gnu::always_inline]] inline void write(const Rows& rows, NodePlane& plane) noexcept {
  std::memcpy(plane.word.data(), &rows, sizeof(rows));
}
[[gnu::always_inline]] inline bool any(const Rows& rows) noexcept {
  NodePlane plane;
  write(rows, plane);
  return (plane.word[0] | plane.word[1] | plane.word[2] | plane.word[3]) != 0;
}

/// Adds each row to the one before it.
[[gnu::always_inline]] inline void add_to_previous(const Rows& rows, Rows& found) noexcept {
  constexpr Rows kNone{};
  found |= __builtin_shufflevector(rows, kNone, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14,
                                   15, 16);
}
[[gnu::always_inline]] inline void add_to_next(const Rows& rows, Rows& found) noexcept {
  constexpr Rows kNone{};
  found |= __builtin_shufflevector(rows, kNone, 16, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12,
                                   13, 14);
}

/// Adds a plane's own nodes on long edges from these.
[[gnu::always_inline]] inline void add_beside_in_plane(const Rows& nodes,
                                                       Rows& found) noexcept {
  found |= nodes << 1 | nodes >> 1;
  add_to_previous(nodes, found);
  add_to_next(nodes, found);
}

/// Adds the centres on short edges from the corners of the next plane: each has four around it.
[[gnu::always_inline]] inline void add_centres_beside(const Rows& corners,
                                                      Rows& found) noexcept {
  const Rows rows = corners | corners >> 1;
  found |= rows;
  add_to_previous(rows, found);
}
[[gnu::always_inline]] inline void add_corners_beside(const Rows& centres,
                                                      Rows& found) noexcept {
  const Rows rows = centres | centres << 1;
  found |= rows;
  add_to_next(rows, found);
}

/// Adds a plane's nodes on edges from these: long ones from itself and the next of its kind,
/// short ones from the other kind.
[[gnu::always_inline]] inline void add_beside(const NodePlanes& from,
                                              std::size_t to,
                                              Rows& found) noexcept {
  Rows rows, other{};
  read(from.plane[to], rows);
  add_beside_in_plane(rows, found);
  const auto add_kind = [&](std::size_t plane, Rows & sum) __attribute__((always_inline)) {
    if (plane >= NodePlanes::kPlanes) return;
    read(from.plane[plane], rows);
    sum |= rows;
  };
  add_kind(to - 2, found);  // wraps below the first
  add_kind(to + 2, found);
  add_kind(to - 1, other);
  add_kind(to + 1, other);
  if (to % 2 == kCorner) {
    add_corners_beside(other, found);
  } else {
    add_centres_beside(other, found);
  }
}

}  // namespace tet::internal
