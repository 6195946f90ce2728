#include "core/vdb/openvdb/surface_to_volume.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <type_traits>
#include <utility>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>
#include <openvdb/tools/ChangeBackground.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/ValueTransformer.h>

#include "core/surface/close_surface.h"
#include "core/surface/outer_surface.h"
#include "core/vdb/openvdb/copy_grid.h"
#include "core/vdb/openvdb/level_set_volume.h"
#include "core/vdb/openvdb/sign_distances.h"
#include "core/vdb/openvdb/surface_grid.h"
#include "core/vdb/openvdb/vdb_grids.h"
#include "core/vdb/openvdb/vdb_transform.h"
#include "core/vdb/openvdb/voxel_surface.h"
#include "core/vdb/openvdb/write_vdb.h"

namespace tet {
namespace {

using openvdb::FloatGrid;
using openvdb::Vec3d;

constexpr double kHalfShell = 1;  // voxels; any thinner and the lattice would tear it

/// Vertices so near are one where edges are open, and where that is not enough those that are
/// nearer than half a voxel, which the grid could not tell apart.
constexpr double kWeldVoxels = 1e-3, kGapVoxels = 0.52;

/// Surfaces that overlap are cut into pieces no longer than this, unless their area would make
/// about five times so many of them. Their lengths may make more: so many at most.
constexpr double kPieceVoxels = 1, kPiecesOfArea = 1e7;
constexpr std::uint64_t kMostPieces = 100'000'000;

/// Holes no wider than this are not to be seen in the grid.
constexpr double kHoleVoxels = 2;

/// A surface in voxels as OpenVDB asks for it.
class IndexSpaceMesh {
 public:
  explicit IndexSpaceMesh(const TriangleSurface& surface) : surface_(&surface) {}

  // OpenVDB's names. NOLINTBEGIN(readability-identifier-naming)
  std::size_t polygonCount() const { return surface_->triangles.size(); }
  std::size_t pointCount() const { return surface_->vertices.size(); }
  std::size_t vertexCount(std::size_t /*polygon*/) const { return 3; }
  void getIndexSpacePoint(std::size_t polygon, std::size_t corner, Vec3d& point) const {
    const WorldPoint& p = surface_->vertices[surface_->triangles[polygon][corner]];
    point = Vec3d(p.x, p.y, p.z);
  }
  // NOLINTEND(readability-identifier-naming)

 private:
  const TriangleSurface* surface_;
};

/// Distances in voxels to a surface in voxels, and the triangle that each is to.
struct Distances {
  FloatGrid::Ptr grid;
  openvdb::Int32Grid::Ptr nearest =
      openvdb::Int32Grid::create(static_cast<std::int32_t>(openvdb::util::INVALID_IDX));
};

Distances measure_distances(const TriangleSurface& surface, double half_band) {
  Distances distances;
  const auto transform = openvdb::math::Transform::createLinearTransform(1.0);
  distances.grid = openvdb::tools::meshToVolume<FloatGrid>(
      IndexSpaceMesh(surface), *transform, static_cast<float>(half_band), 0,
      openvdb::tools::UNSIGNED_DISTANCE_FIELD, distances.nearest.get());
  return distances;
}

/// The level set of all points within kHalfShell of the surface.
FloatGrid::Ptr make_shell(const TriangleSurface& surface) {
  const FloatGrid::Ptr grid = measure_distances(surface, kHalfBand + kHalfShell).grid;
  constexpr auto kHalf = static_cast<float>(kHalfShell);
  openvdb::tools::foreach (grid->beginValueOn(),
                           [](const FloatGrid::ValueOnIter& it) { it.setValue(*it - kHalf); });
  openvdb::tools::changeBackground(grid->tree(), grid->background() - kHalf);
  return grid;
}

/// Error: that of outer_surface.
absl::StatusOr<FloatGrid::Ptr> make_solid(const ClosedSurface& closed,
                                          std::uint64_t most_pieces,
                                          ConversionReport& report) {
  const WindingTree tree(closed.surface);
  Distances distances = measure_distances(closed.surface, kHalfBand);
  SignFindings found =
      sign_distances(closed.surface, tree, *distances.nearest, *distances.grid);
  report.overlaps = found.overlaps;
  if (found.overlaps) {
    // Sheets within the solid would be told as its surface by the distances to them.
    const double piece = std::max(kPieceVoxels, std::sqrt(closed.area / kPiecesOfArea));
    const absl::StatusOr<TriangleSurface> outer =
        outer_surface(closed.surface, tree, piece, most_pieces);
    if (!outer.ok()) return outer.status();
    distances = measure_distances(*outer, kHalfBand);
    found = sign_distances(*outer, tree, *distances.nearest, *distances.grid);
  } else {
    report.lost_bodies = count_lost_bodies(closed, *distances.nearest, *distances.grid);
  }
  report.hidden_walls = found.hidden.walls;
  report.hidden_gaps = found.hidden.gaps;
  return distances.grid;
}

bool has_inside(const FloatGrid& grid) {
  for (auto value = grid.cbeginValueOn(); value; ++value) {
    if (*value < 0) return true;
  }
  return false;
}

/// Whether a grid is made of the surface, and of which kind.
absl::StatusOr<ConvertedTo> choose_kind(const ClosedSurface& closed, OpenSurface open) {
  if (closed.holes == 0) return ConvertedTo::kSolid;
  if (closed.nearly_closed(kHoleVoxels)) return ConvertedTo::kMendedSolid;
  if (open == OpenSurface::kShell) return ConvertedTo::kShell;
  if (open == OpenSurface::kClose) return ConvertedTo::kClosedSolid;
  return absl::FailedPreconditionError("the surface is not closed");
}

ConversionReport describe(const TriangleSurface& surface,
                          const ClosedSurface& closed,
                          double voxel_size) {
  const double square = voxel_size * voxel_size;
  ConversionReport report;
  report.vertices = surface.vertices.size();
  report.triangles = surface.triangles.size();
  report.voxel_size = voxel_size;
  report.open_edges = closed.open_edges;
  report.non_manifold_edges = closed.non_manifold_edges;
  report.holes = closed.holes;
  report.doubled_triangles = closed.doubled_triangles;
  report.turned_triangles = closed.turned_triangles;
  report.turned_bodies = closed.turned_bodies;
  report.area = closed.area * square;
  report.hole_area = closed.cap_area * square;
  report.widest_hole = closed.widest_hole * voxel_size;
  return report;
}

/// The advice is a voxel size that shows a plate of the surface's volume and area.
absl::Status nothing_inside(const ClosedSurface& closed, double voxel_size) {
  const double thickness = closed.area > 0 ? 2 * closed.volume / closed.area : 0;
  if (!(thickness > 1e-6)) {
    return absl::InvalidArgumentError(
        "the surface encloses nothing: it is a sheet without thickness, which no voxel size "
        "makes a solid; choose --open shell, or give it a thickness");
  }
  return absl::InvalidArgumentError(
      absl::StrFormat("voxel size %g is too large: no voxel centre lies inside the surface, "
                      "whose walls are about "
                      "%.3g thick; use at most %.3g",
                      voxel_size, thickness * voxel_size, thickness * voxel_size / 2.5));
}

struct Converted {
  FloatGrid::Ptr grid;  ///< in world units, with metadata
  ConversionReport report;
};

/// From voxels to world units; the metadata say what the grid was made of.
void finish(const VoxelSurface& voxels, Converted& converted) {
  FloatGrid& grid = *converted.grid;
  const auto size = static_cast<float>(voxels.voxel_size);
  const float background = grid.background() * size;
  if (size != 1) {
    for (auto leaf = grid.tree().beginLeaf(); leaf; ++leaf) {
      float* const value = leaf->buffer().data();
      std::for_each(value, value + kBrickCells, [&](float& v) { v *= size; });
    }
    auto tile = grid.tree().beginValueAll();
    tile.setMaxDepth(FloatGrid::TreeType::ValueAllIter::LEAF_DEPTH - 1);
    for (; tile; ++tile) tile.setValue(*tile * size);
    grid.tree().root().setBackground(background, /*updateChildNodes=*/false);
  }
  grid.setTransform(uniform_transform(voxels.voxel_size, voxels.translation));
  grid.setGridClass(openvdb::GRID_LEVEL_SET);
  grid.setName("surface");
  grid.insertMeta(kSurfaceMetadata, openvdb::StringMetadata(converted.report.text()));
  const auto warnings = converted.report.warnings();
  for (std::size_t i = 0; i < warnings.size(); ++i) {
    grid.insertMeta(absl::StrFormat("%s_warning_%d", kSurfaceMetadata, i + 1),
                    openvdb::StringMetadata(warnings[i]));
  }
}

absl::StatusOr<Converted> convert(const TriangleSurface& surface,
                                  double voxel_size,
                                  OpenSurface open,
                                  std::uint64_t most_pieces = kMostPieces) {
  const absl::StatusOr<VoxelSurface> voxels = to_voxels(surface, voxel_size);
  if (!voxels.ok()) return voxels.status();
  openvdb::initialize();
  const ClosedSurface closed = close_surface(voxels->surface, kWeldVoxels, kGapVoxels);
  Converted result;
  result.report = describe(surface, closed, voxel_size);
  const absl::StatusOr<ConvertedTo> kind = choose_kind(closed, open);
  if (!kind.ok()) {
    return absl::FailedPreconditionError(open_surface_refusal(result.report));
  }
  result.report.kind = *kind;
  const bool shell = *kind == ConvertedTo::kShell;
  absl::StatusOr<FloatGrid::Ptr> made =
      shell ? make_shell(voxels->surface) : make_solid(closed, most_pieces, result.report);
  if (!made.ok()) return made.status();
  result.grid = *std::move(made);
  if (!has_inside(*result.grid)) return nothing_inside(closed, voxel_size);
  const double cube = voxel_size * voxel_size * voxel_size;
  result.report.volume = level_set_volume(*result.grid) * cube;
  if (!shell && !result.report.overlaps) result.report.surface_volume = closed.volume * cube;
  result.report.active_voxels = result.grid->activeVoxelCount();
  finish(*voxels, result);
  return result;
}

/// Calls `work`; what OpenVDB throws becomes a status.
template <class Work>
std::invoke_result_t<Work> guarded(const Work& work) {
  try {
    return work();
  } catch (const std::exception& error) {
    return absl::InternalError(
        absl::StrFormat("the surface could not be converted: %s", error.what()));
  }
}

}  // namespace

absl::StatusOr<SurfaceVolume> surface_to_volume(const TriangleSurface& surface,
                                                double voxel_size,
                                                OpenSurface open) {
  return guarded([&]() -> absl::StatusOr<SurfaceVolume> {
    const absl::StatusOr<Converted> converted = convert(surface, voxel_size, open);
    if (!converted.ok()) return converted.status();
    absl::StatusOr<Volume> volume = copy_grid(*converted->grid);
    if (!volume.ok()) return volume.status();
    return SurfaceVolume{*std::move(volume), converted->report};
  });
}

absl::StatusOr<FloatGrid::Ptr> surface_to_grid(const TriangleSurface& surface,
                                               double voxel_size,
                                               OpenSurface open,
                                               std::uint64_t most_pieces) {
  return guarded([&]() -> absl::StatusOr<FloatGrid::Ptr> {
    absl::StatusOr<Converted> converted = convert(surface, voxel_size, open, most_pieces);
    if (!converted.ok()) return converted.status();
    return std::move(converted->grid);
  });
}

absl::StatusOr<ConversionReport> surface_to_vdb(const TriangleSurface& surface,
                                                double voxel_size,
                                                const std::string& path,
                                                OpenSurface open) {
  return guarded([&]() -> absl::StatusOr<ConversionReport> {
    const absl::StatusOr<Converted> converted = convert(surface, voxel_size, open);
    if (!converted.ok()) return converted.status();
    if (absl::Status s = write_vdb(converted->grid, path); !s.ok()) return s;
    return converted->report;
  });
}

}  // namespace tet
