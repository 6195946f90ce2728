#include "core/plan/sample_points.h"

#include <cmath>
#include <string>
#include <utility>

#include <absl/status/status.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/base/parallel.h"
#include "core/field/world_phi.h"
#include "core/plan/mesh_place.h"
#include "core/plan/sample_fields.h"

namespace tet {
namespace {

constexpr std::size_t kPointsPerRange = 1024;
/// What a scene's slope is measured over, in spacings.
constexpr double kSlopeStep = 1e-4;

static_assert(sizeof(WorldPoint) == 3 * sizeof(double));

MeshHeader header_of_points(const MeshRequest& request, const PhiField& field) {
  MeshHeader header;
  header.coordinate_type = CoordinateType::kFloat64;
  header.fields = arrays_of(request.fields);
  header.inside_guess = inside_guess_of(field, request);
  return header;
}

}  // namespace

absl::StatusOr<ShapeSampler> ShapeSampler::make(Shape shape, MeshRequest request) {
  if (grids_of(shape) != nullptr) {
    return absl::InvalidArgumentError(
        "several grids have no phi in common: sample one of them");
  }
  if (request.labels || labels_of(shape) != nullptr) {
    return absl::InvalidArgumentError(
        "labels have no phi, which tells two sides apart: sample a grid of distances");
  }
  absl::StatusOr<MeshedField> field = meshed_field(shape, request);
  if (!field.ok()) return field.status();
  return ShapeSampler(std::move(shape), std::move(request), *std::move(field));
}

ShapeSampler::ShapeSampler(Shape shape, MeshRequest request, MeshedField field)
    : shape_(std::move(shape)),
      request_(std::move(request)),
      field_(std::move(field)),
      header_(header_of_points(request_, field_.phi)) {}

void ShapeSampler::sample(std::span<const WorldPoint> points,
                          const SampleColumns& columns,
                          const Cancellation& cancellation) const {
  for_each_range(points.size(), kPointsPerRange, [&](std::size_t begin, std::size_t end) {
    if (cancellation.requested()) return;
    const std::size_t count = end - begin;
    sample_range(points.subspan(begin, count), columns.part(begin, count, width()));
  });
}

void ShapeSampler::sample_range(std::span<const WorldPoint> points,
                                const SampleColumns& columns) const {
  WorldPhi phi(field_.phi, kSlopeStep * field_.phi.lattice_transform().voxel_size);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const PhiSlope found = phi.slope_at(points[i]);
    columns.phi[i] = found.phi;
    columns.slopes[3 * i] = found.gradient.x;
    columns.slopes[3 * i + 1] = found.gradient.y;
    columns.slopes[3 * i + 2] = found.gradient.z;
  }
  if (width() == 0) return;
  sample_fields(request_.fields, header_, std::as_bytes(points),
                std::as_writable_bytes(columns.fields));
}

absl::Status check_points(std::span<const WorldPoint> points, std::uint64_t first) {
  const auto is_place = [](double v) { return std::abs(v) <= kMostOfAPoint; };
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& [x, y, z] = points[i];
    if (is_place(x) && is_place(y) && is_place(z)) continue;
    const bool is_finite = std::isfinite(x) && std::isfinite(y) && std::isfinite(z);
    const std::string place = absl::StrFormat("point %d (%g %g %g)", first + i, x, y, z);
    return absl::InvalidArgumentError(
        is_finite ? absl::StrFormat("%s is farther than %g from the origin: are its "
                                    "coordinates world units?",
                                    place, kMostOfAPoint)
                  : absl::StrCat(place, " is not finite"));
  }
  return absl::OkStatus();
}

void PointSamples::resize(std::size_t points) {
  phi.resize(points);
  slopes.resize(3 * points);
  fields.resize(width * points);
}

PointSamples samples_for(const ShapeSampler& sampler, std::size_t points) {
  PointSamples samples{.arrays = sampler.arrays(),
                       .width = sampler.width(),
                       .inside_guess = sampler.inside_guess(),
                       .phi = {},
                       .slopes = {},
                       .fields = {}};
  samples.resize(points);
  return samples;
}

absl::StatusOr<PointSamples> sample_points(const Shape& shape,
                                           const MeshRequest& request,
                                           std::span<const WorldPoint> points,
                                           const Cancellation& cancellation) {
  const absl::StatusOr<ShapeSampler> sampler = ShapeSampler::make(shape, request);
  if (!sampler.ok()) return sampler.status();
  if (auto status = check_points(points); !status.ok()) return status;
  PointSamples samples = samples_for(*sampler, points.size());
  sampler->sample(points, samples.columns(), cancellation);
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  return samples;
}

}  // namespace tet
