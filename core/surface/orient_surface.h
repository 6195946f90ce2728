// Triangles that are wound one way or the other are wound alike.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/surface/edge_runs.h"
#include "core/surface/triangle_surface.h"

namespace tet {

/// The pieces of a surface: triangles that meet in edges of two triangles belong together.
struct SurfacePieces {
  std::vector<std::uint32_t> piece_of;  ///< by triangle
  std::uint32_t count = 0;
};

SurfacePieces find_pieces(std::span<const SurfaceSide> sides, std::size_t triangles);

/// Winds the triangles of each piece alike, the way most of its area is wound already; where
/// there is no such way, outwards. Returns how many triangles were turned. A piece that cannot
/// be wound alike (a Moebius strip) stays as it is where the ends meet.
std::uint64_t wind_alike(std::span<const SurfaceSide> sides,
                         const SurfacePieces& pieces,
                         TriangleSurface& surface);

/// Turns a triangle round.
inline void turn(std::array<std::uint32_t, 3>& triangle) {
  std::swap(triangle[1], triangle[2]);
}

/// Twice the area.
double twice_area(const TriangleSurface& surface, const std::array<std::uint32_t, 3>& t);

/// Six times the volume of the tet of a triangle and `apex`: positive where the triangle faces
/// away from it.
double six_volume(const TriangleSurface& surface,
                  const std::array<std::uint32_t, 3>& t,
                  const WorldPoint& apex);

}  // namespace tet
