#include "core/vdb/surface_to_volume.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <exception>
#include <functional>
#include <type_traits>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>
#include <openvdb/tools/ChangeBackground.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/ValueTransformer.h>

#include "core/surface/surface_edges.h"
#include "core/vdb/copy_grid.h"
#include "core/vdb/vdb_grids.h"
#include "core/vdb/write_vdb.h"

namespace tet {
namespace {

using openvdb::FloatGrid;
using openvdb::Vec3d;

constexpr double kHalfBand = 3;   // voxels
constexpr double kHalfShell = 1;  // voxels; any thinner and the lattice would tear it

/// Conversion takes about 16 bytes for a voxel of the band.
constexpr double kMaxBandVoxels = 1e9;

/// The surface as OpenVDB asks for it: in voxels, in double.
class IndexSpaceMesh {
 public:
  IndexSpaceMesh(const TriangleSurface& surface, double voxel_size)
      : surface_(&surface), voxel_size_(voxel_size) {}

  // OpenVDB's names.
  std::size_t polygonCount() const { return surface_->triangles.size(); }
  std::size_t pointCount() const { return surface_->vertices.size(); }
  std::size_t vertexCount(std::size_t /*polygon*/) const { return 3; }
  void getIndexSpacePoint(std::size_t polygon, std::size_t corner, Vec3d& point) const {
    const WorldPoint& p = surface_->vertices[surface_->triangles[polygon][corner]];
    point = Vec3d(p.x, p.y, p.z) / voxel_size_;
  }

 private:
  const TriangleSurface* surface_;
  double voxel_size_;
};

openvdb::BBoxd bounds(const IndexSpaceMesh& mesh) {
  openvdb::BBoxd box;
  Vec3d point;
  for (std::size_t i = 0; i < mesh.polygonCount(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      mesh.getIndexSpacePoint(i, c, point);
      box.expand(point);
    }
  }
  return box;
}

/// About how many voxels lie within the band: around each triangle, and no more than the box
/// holds.
double estimate_band_voxels(const IndexSpaceMesh& mesh, const openvdb::BBoxd& box) {
  constexpr double kBand = 2 * kHalfBand + 1;
  double around = 0;
  std::array<Vec3d, 3> p;
  for (std::size_t i = 0; i < mesh.polygonCount(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) mesh.getIndexSpacePoint(i, c, p[c]);
    const double area = (p[1] - p[0]).cross(p[2] - p[0]).length() / 2;
    const double length = std::max((p[1] - p[0]).length(), (p[2] - p[0]).length());
    around += area * kBand + length * kBand * kBand;
  }
  const Vec3d within = box.extents() + Vec3d(kBand);
  return std::min(around, within.x() * within.y() * within.z());
}

absl::Status check_size(const IndexSpaceMesh& mesh, double voxel_size) {
  const openvdb::BBoxd box = bounds(mesh);
  const double farthest = std::max(-box.min()[openvdb::math::MinIndex(box.min())],
                                   box.max()[openvdb::math::MaxIndex(box.max())]);
  constexpr double kMargin = 128;  // voxels: the band, and the nodes that hold it
  if (!(farthest < kMaxVoxelCoord - kMargin)) {
    return absl::ResourceExhaustedError(absl::StrFormat(
        "with voxel size %g the surface reaches %g voxels from the origin and the limit is %d: "
        "use larger voxels, or move the surface to the origin",
        voxel_size, farthest, kMaxVoxelCoord));
  }
  const double voxels = estimate_band_voxels(mesh, box);
  if (voxels > kMaxBandVoxels) {
    return absl::ResourceExhaustedError(absl::StrFormat(
        "with voxel size %g the band around the surface holds about %.3g voxels and the limit "
        "is %.3g: use larger voxels",
        voxel_size, voxels, kMaxBandVoxels));
  }
  return absl::OkStatus();
}

FloatGrid::Ptr convert_closed(const IndexSpaceMesh& mesh,
                              const openvdb::math::Transform& transform) {
  return openvdb::tools::meshToVolume<FloatGrid>(mesh, transform, kHalfBand, kHalfBand);
}

/// The level set of all points within kHalfShell of the surface.
FloatGrid::Ptr convert_open(const IndexSpaceMesh& mesh,
                            const openvdb::math::Transform& transform) {
  const FloatGrid::Ptr grid = openvdb::tools::meshToVolume<FloatGrid>(
      mesh, transform, static_cast<float>(kHalfBand + kHalfShell), 0,
      openvdb::tools::UNSIGNED_DISTANCE_FIELD);
  const auto half_shell = static_cast<float>(kHalfShell * transform.voxelSize().x());
  openvdb::tools::foreach (
      grid->beginValueOn(),
      [half_shell](const FloatGrid::ValueOnIter& it) { it.setValue(*it - half_shell); });
  openvdb::tools::changeBackground(grid->tree(), grid->background() - half_shell);
  return grid;
}

bool has_inside(const FloatGrid& grid) {
  for (auto value = grid.cbeginValueOn(); value; ++value) {
    if (*value < 0) return true;
  }
  return false;
}

struct Converted {
  FloatGrid::Ptr grid;
  ConversionReport report;
};

absl::StatusOr<Converted> convert(const TriangleSurface& surface, double voxel_size) {
  if (!(voxel_size > 0) || !std::isfinite(voxel_size)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("voxel size %g is not positive", voxel_size));
  }
  if (surface.triangles.empty()) {
    return absl::InvalidArgumentError("the surface has no triangle");
  }
  const IndexSpaceMesh mesh(surface, voxel_size);
  if (absl::Status s = check_size(mesh, voxel_size); !s.ok()) return s;

  openvdb::initialize();
  const SurfaceEdges edges = count_edges(surface);
  const auto transform = openvdb::math::Transform::createLinearTransform(voxel_size);
  const bool closed = edges.open == 0;
  Converted result;
  result.grid = closed ? convert_closed(mesh, *transform) : convert_open(mesh, *transform);
  if (!has_inside(*result.grid)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "voxel size %g is too large: no voxel centre lies inside the surface", voxel_size));
  }
  result.grid->setGridClass(openvdb::GRID_LEVEL_SET);
  result.grid->setName("surface");
  result.report = {surface.vertices.size(),
                   surface.triangles.size(),
                   edges.open,
                   edges.non_manifold,
                   closed,
                   0};
  result.report.active_voxels = result.grid->activeVoxelCount();
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

std::string ConversionReport::text() const {
  const std::string found =
      absl::StrFormat("%d triangles, %d vertices", triangles, vertices) +
      (non_manifold_edges == 0
           ? ""
           : absl::StrFormat(", %d non-manifold edges", non_manifold_edges));
  if (closed) {
    return absl::StrFormat(
        "closed surface (%s): a signed level set of what it encloses, %d active voxels", found,
        active_voxels);
  }
  return absl::StrFormat(
      "open surface (%s, %d open edges): it has no inside, so it became a shell two voxels "
      "thick, %d active voxels",
      found, open_edges, active_voxels);
}

absl::StatusOr<SurfaceVolume> surface_to_volume(const TriangleSurface& surface,
                                                double voxel_size) {
  return guarded([&]() -> absl::StatusOr<SurfaceVolume> {
    const absl::StatusOr<Converted> converted = convert(surface, voxel_size);
    if (!converted.ok()) return converted.status();
    absl::StatusOr<Volume> volume = copy_grid(*converted->grid);
    if (!volume.ok()) return volume.status();
    return SurfaceVolume{*std::move(volume), converted->report};
  });
}

absl::StatusOr<ConversionReport> surface_to_vdb(const TriangleSurface& surface,
                                                double voxel_size,
                                                const std::string& path) {
  return guarded([&]() -> absl::StatusOr<ConversionReport> {
    const absl::StatusOr<Converted> converted = convert(surface, voxel_size);
    if (!converted.ok()) return converted.status();
    if (absl::Status s = write_vdb(converted->grid, path); !s.ok()) return s;
    return converted->report;
  });
}

}  // namespace tet
