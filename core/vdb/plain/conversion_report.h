// What the conversion of a surface found and did, for people and for programs.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace tet {

/// The metadata of a converted grid: `text()`, and under this name with "_warning_1" and so on
/// its warnings.
inline constexpr const char* kSurfaceMetadata = "tetstream_surface";

/// What to do with a surface whose holes are too large to be faults of its file.
enum class OpenSurface : std::uint8_t {
  kRefuse,  ///< it has no inside, and someone has to say what is meant
  kShell,   ///< a solid two voxels thick around the surface
  kClose,   ///< the holes are capped, each with a fan of triangles around its middle
};

/// What a surface became.
enum class ConvertedTo : std::uint8_t {
  kSolid,        ///< it was closed
  kMendedSolid,  ///< it was closed but for small holes, which were capped
  kClosedSolid,  ///< it was open, and was closed as it was asked for
  kShell,        ///< it was open, and was made a shell as it was asked for
};

/// Stable names, for reports: "solid", "mended solid", "closed solid", "shell".
const char* name_of(ConvertedTo kind) noexcept;

/// Lengths, areas and volumes in world units.
struct ConversionReport {
  ConvertedTo kind = ConvertedTo::kSolid;
  std::uint64_t vertices = 0, triangles = 0;
  double voxel_size = 0;
  std::uint64_t active_voxels = 0;

  std::uint64_t open_edges = 0;          ///< of one triangle only
  std::uint64_t non_manifold_edges = 0;  ///< of three or more
  std::uint64_t holes = 0;               ///< loops of open edges
  std::uint64_t doubled_triangles = 0;   ///< left out, as others have the same corners
  std::uint64_t turned_triangles = 0;    ///< wound against their neighbours
  std::uint64_t turned_bodies = 0;       ///< wound inside out
  bool overlaps = false;                 ///< solids overlap or lie within others: they are one

  double area = 0;       ///< of the surface
  double hole_area = 0;  ///< of the caps
  double widest_hole = 0;
  /// What the surface goes around, by divergence; none of a shell, or where solids overlap.
  std::optional<double> surface_volume;
  double volume = 0;                                ///< of the level set
  std::uint64_t lost_bodies = 0;                    ///< and cavities, smaller than voxels
  std::uint64_t hidden_walls = 0, hidden_gaps = 0;  ///< that pass between voxel centres

  /// Tells in one sentence what was found, and what was done.
  std::string text() const;
  /// What may be wrong with the result, one sentence each; none when it is as it should be.
  std::vector<std::string> warnings() const;
  /// How far a volume of this surface may be off at a spacing: what rounding edges off takes.
  double volume_tolerance(double spacing) const noexcept;
};

/// Refusal of an open surface, and what can be done.
std::string open_surface_refusal(const ConversionReport& report);

}  // namespace tet
