// Small .vdb files of known solids, and of grids that must be refused.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tet::test {

/// Every kind that `write_fixture` knows:
///
/// - level sets, half band three voxels: "sphere" (radius 1), "torus" (radii 1 and 0.4),
/// "gyroid"
///   (a sheet of one within radius 1.2), "two-spheres" (radius 0.5 at x = -0.7 and 0.7),
///   "cavity" (radius 1 with a hole of radius 0.5), "random-signs" (40^3 voxels of any sign);
/// - "fog": a density, 1 within the unit ball and 0 outside;
/// - refused: "empty", "vec3", "points", "sheared".
///
/// And "fields", a file of several: the level set "sphere"; "heat" (float), which is
/// 1 + 2x - 3y + z/2 within 1.6 of the origin on each axis and -7 elsewhere, in voxels 1.5
/// times as wide that lie between those of the sphere; "velocity" (vec3s), (x - y, 2z, 1 + x/4)
/// and else (0, 0, -1), in voxels twice as wide; and "count", of whole numbers.
///
/// And "parts", a file of several solids: the level sets "ball" (radius 1), "ring" (radii 1 and
/// 0.4, at x = 3, turned about z, in voxels 1.5 times as wide) and "twin" (as two-spheres, in
/// the voxels of the ball); the density "cloud" (radius 1, at about y = 3, on voxels of its
/// own); and "velocity", as above, which cannot be meshed.
///
/// And "flow", the "sphere" and the "velocity" of "fields": one grid can be meshed, and both
/// have values.
std::vector<std::string_view> fixture_kinds();

/// Writes one grid named after its kind, with voxels of `voxel` world units, centred at the
/// origin. Throws std::invalid_argument for an unknown kind, openvdb::Exception when it cannot
/// write.
void write_fixture(std::string_view kind, double voxel, const std::string& path);

}  // namespace tet::test
