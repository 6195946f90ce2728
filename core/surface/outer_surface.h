// The part of a surface that lies between inside and outside.
#pragma once

#include <cstdint>

#include <absl/status/statusor.h>

#include "core/surface/triangle_surface.h"
#include "core/surface/winding_tree.h"

namespace tet {

/// Points with a winding number above this are inside: on a face of a solid they are not, where
/// two solids touch they are.
inline constexpr double kInsideWinding = 0.75;

/// Cuts triangles into pieces no longer than `edge` and keeps those that have inside on one
/// side and outside on the other: solids that overlap have sheets within, which bound nothing.
/// `tree` is of the surface. Vertices are not shared between pieces.
///
/// Error: kResourceExhausted, before any piece is kept, where there would be more than
/// `most_pieces`, and more than twice as many as triangles. About 160 bytes a piece are held at
/// once.
absl::StatusOr<TriangleSurface> outer_surface(const TriangleSurface& surface,
                                              const WindingTree& tree,
                                              double edge,
                                              std::uint64_t most_pieces);

}  // namespace tet
