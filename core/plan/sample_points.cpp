#include "core/plan/sample_points.h"

#include <cmath>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "core/base/parallel.h"
#include "core/plan/prepared_mesh.h"
#include "core/plan/sample_fields.h"

namespace tet {
namespace {

constexpr std::size_t kPointsPerRange = 1024;
/// What a scene's slope is measured over, in spacings.
constexpr double kSlopeStep = 1e-4;

absl::Status check_points(std::span<const WorldPoint> points) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& [x, y, z] = points[i];
    if (std::isfinite(x) && std::isfinite(y) && std::isfinite(z)) continue;
    return absl::InvalidArgumentError(
        absl::StrFormat("point %d (%g %g %g) is not finite", i, x, y, z));
  }
  return absl::OkStatus();
}

/// A mesh whose vertices are the points, as far as fields ask of one.
MeshHeader header_of_points(std::span<const VertexField> fields) {
  MeshHeader header;
  header.coordinate_type = CoordinateType::kFloat64;
  header.fields = arrays_of(fields);
  return header;
}

}  // namespace

absl::StatusOr<PointSamples> sample_points(const Shape& shape,
                                           const MeshRequest& request,
                                           std::span<const WorldPoint> points,
                                           const Cancellation& cancellation) {
  if (grids_of(shape) != nullptr) {
    return absl::InvalidArgumentError(
        "several grids have no phi in common: sample one of them");
  }
  if (auto status = check_points(points); !status.ok()) return status;
  const absl::StatusOr<MeshedField> field = meshed_field(shape, request);
  if (!field.ok()) return field.status();
  const MeshHeader header = header_of_points(request.fields);
  PointSamples samples{.phi = std::vector<PhiSlope>(points.size()),
                       .arrays = header.fields,
                       .width = header.field_values(),
                       .values = {}};
  samples.values.resize(points.size() * samples.width);
  const double step = kSlopeStep * field->phi.lattice_transform().voxel_size;
  static_assert(sizeof(WorldPoint) == 3 * sizeof(double));
  for_each_range(points.size(), kPointsPerRange, [&](std::size_t begin, std::size_t end) {
    if (cancellation.requested()) return;
    WorldPhi phi(field->phi, step);
    for (std::size_t i = begin; i < end; ++i) samples.phi[i] = phi.slope_at(points[i]);
    if (samples.width == 0) return;
    const std::span<float> rows =
        std::span(samples.values).subspan(begin * samples.width, (end - begin) * samples.width);
    sample_fields(request.fields, header, std::as_bytes(points.subspan(begin, end - begin)),
                  std::as_writable_bytes(rows));
  });
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  return samples;
}

}  // namespace tet
