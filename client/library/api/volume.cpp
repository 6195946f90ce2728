#include "tetstream/volume.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "client/library/api/sampled_volume.h"
#include "client/library/api/to_public.h"
#include "client/library/api/volume_impl.h"
#include "client/library/api/work.h"
#include "client/library/read_grids.h"
#include "core/triangle_files/surface_file.h"
#include "core/vdb/openvdb/openvdb_part.h"

namespace tetstream {
namespace {

tet::FileTrust trust_of(const VdbOptions& options) {
  return options.trusted ? tet::FileTrust::kFull : tet::FileTrust::kNone;
}

Result<Volume> public_volume(absl::StatusOr<tet::Volume> volume) {
  if (!volume.ok()) return to_public(volume.status());
  return Volume(std::make_shared<const Volume::Impl>(
      Volume::Impl{{std::make_shared<const tet::Volume>(*std::move(volume))}}));
}

tet::OpenSurface choice_of(OpenSurface open) {
  switch (open) {
    case OpenSurface::kClose:
      return tet::OpenSurface::kClose;
    case OpenSurface::kShell:
      return tet::OpenSurface::kShell;
    default:
      return tet::OpenSurface::kRefuse;
  }
}

absl::StatusOr<tet::Volume> converted(const absl::StatusOr<tet::TriangleSurface>& surface,
                                      double voxel_size,
                                      OpenSurface open) {
  if (!surface.ok()) return surface.status();
  auto made = tet::with_openvdb([&](const tet::OpenVdbPart& part) {
    return part.surface_to_volume(*surface, voxel_size, choice_of(open));
  });
  if (!made.ok()) return made.status();
  return std::move(made->volume);
}

absl::StatusOr<tet::TriangleSurface> surface_of(const Triangles& triangles) {
  if (triangles.points.size() % 3 != 0 || triangles.triangles.size() % 3 != 0) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%d coordinates and %d vertex ids: each must be a multiple of 3",
                        triangles.points.size(), triangles.triangles.size()));
  }
  tet::TriangleSurface surface;
  for (std::size_t i = 0; i < triangles.points.size(); i += 3) {
    const tet::WorldPoint p{triangles.points[i], triangles.points[i + 1],
                            triangles.points[i + 2]};
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
      return absl::InvalidArgumentError(
          absl::StrFormat("vertex %d has a coordinate that is not finite", i / 3));
    }
    surface.vertices.push_back(p);
  }
  for (std::size_t i = 0; i < triangles.triangles.size(); i += 3) {
    const std::array<std::uint32_t, 3> ids{triangles.triangles[i], triangles.triangles[i + 1],
                                           triangles.triangles[i + 2]};
    for (const std::uint32_t id : ids) {
      if (id < surface.vertices.size()) continue;
      return absl::InvalidArgumentError(
          absl::StrFormat("triangle %d refers to vertex %d, and there are %d", i / 3, id,
                          surface.vertices.size()));
    }
    surface.triangles.push_back(ids);
  }
  return surface;
}

/// The first component says how many there are.
Result<Volume> read_values(const std::string& path, const VdbOptions& options) {
  Volume::Impl volume;
  std::uint32_t count = 1;
  for (std::uint32_t i = 0; i < count; ++i) {
    absl::StatusOr<tet::Volume> component =
        tet::read_field(path, options.grid, i, trust_of(options), tet::Cancellation());
    if (!component.ok()) return to_public(component.status());
    count = tet::components_of(component->kind);
    volume.components.push_back(std::make_shared<const tet::Volume>(*std::move(component)));
  }
  return Volume(std::make_shared<const Volume::Impl>(std::move(volume)));
}

}  // namespace

Volume::Volume(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}

Result<Volume> Volume::from_samples(const SampleArray& samples) {
  return guarded([&] { return public_volume(volume_of_samples(samples)); });
}

Result<Volume> Volume::from_vdb(const std::string& path, const VdbOptions& options) {
  return guarded([&] {
    return public_volume(
        tet::read_volume(path, options.grid, trust_of(options), tet::Cancellation()));
  });
}

Result<Volume> Volume::values_from_vdb(const std::string& path, const VdbOptions& options) {
  return guarded([&] { return read_values(path, options); });
}

Result<Volume> Volume::from_triangles(const Triangles& triangles,
                                      double voxel_size,
                                      OpenSurface open) {
  return guarded(
      [&] { return public_volume(converted(surface_of(triangles), voxel_size, open)); });
}

Result<Volume> Volume::from_surface_file(const std::string& path,
                                         double voxel_size,
                                         OpenSurface open) {
  return guarded(
      [&] { return public_volume(converted(tet::read_surface(path), voxel_size, open)); });
}

VolumeKind Volume::kind() const noexcept {
  switch (impl_->components.front()->kind) {
    case tet::VolumeKind::kLevelSet:
      return VolumeKind::kLevelSet;
    case tet::VolumeKind::kFogVolume:
      return VolumeKind::kDensity;
    default:
      return VolumeKind::kValues;
  }
}

double Volume::voxel_size() const noexcept {
  return impl_->components.front()->transform.voxel_size;
}

Status Volume::write_vdb(const std::string& path) const {
  return guarded([&]() -> Status {
    if (impl_->components.size() > 1) {
      return {StatusCode::kUnimplemented, "vectors cannot be written to a .vdb file yet"};
    }
    return to_public(tet::with_openvdb([&](const tet::OpenVdbPart& part) {
      return part.write_volume(*impl_->components.front(), path);
    }));
  });
}

}  // namespace tetstream
