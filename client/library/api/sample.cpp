#include "tetstream/sample.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <absl/strings/str_format.h>

#include "client/library/api/client_impl.h"
#include "client/library/api/core_request.h"
#include "client/library/api/to_public.h"
#include "client/library/api/work.h"
#include "client/library/served_samples.h"
#include "core/base/parallel.h"
#include "core/plan/sample_points.h"

namespace tetstream {
namespace {

/// Between two words about progress.
constexpr std::size_t kPointsPerStep = std::size_t{1} << 16;

absl::StatusOr<std::vector<tet::WorldPoint>> places_of(std::span<const double> points) {
  if (points.size() % 3 != 0) {
    return absl::InvalidArgumentError(
        absl::StrFormat("points has %d numbers; each point has three", points.size()));
  }
  std::vector<tet::WorldPoint> places(points.size() / 3);
  for (std::size_t i = 0; i < places.size(); ++i) {
    places[i] = {points[3 * i], points[3 * i + 1], points[3 * i + 2]};
  }
  if (auto status = tet::check_points(places); !status.ok()) return status;
  return places;
}

PointSamples public_samples(tet::PointSamples&& samples) {
  PointSamples result{.phi = std::move(samples.phi),
                      .slopes = std::move(samples.slopes),
                      .fields = std::move(samples.fields),
                      .arrays = {},
                      .field_values = 0,
                      .inside_guess = std::move(samples.inside_guess)};
  for (const tet::FieldArray& array : samples.arrays) {
    result.arrays.push_back({array.name, array.components, result.field_values});
    result.field_values += array.components;
  }
  return result;
}

/// Run it on a TaskPool.
absl::StatusOr<tet::PointSamples> sample_steps(const tet::ShapeSampler& sampler,
                                               std::span<const tet::WorldPoint> points,
                                               const WorkOptions& options,
                                               const tet::Cancellation& cancellation) {
  tet::PointSamples samples = tet::samples_for(sampler, points.size());
  for (std::size_t first = 0; first < points.size(); first += kPointsPerStep) {
    const std::size_t count = std::min(kPointsPerStep, points.size() - first);
    sampler.sample(points.subspan(first, count),
                   samples.columns().part(first, count, samples.width), cancellation);
    if (auto status = check_cancelled(cancellation); !status.ok()) return status;
    if (!options.progress) continue;
    options.progress(static_cast<double>(first + count) / static_cast<double>(points.size()));
  }
  return samples;
}

template <class Solid>
Result<PointSamples> sample_of(const Solid& solid,
                               std::span<const double> points,
                               const Request& request,
                               const WorkOptions& options) {
  return guarded([&]() -> Result<PointSamples> {
    const Work work(options);
    const auto places = places_of(points);
    if (!places.ok()) return to_public(places.status());
    absl::StatusOr<tet::Shape> shape = shape_of(solid);
    if (!shape.ok()) return to_public(shape.status());
    absl::StatusOr<tet::MeshRequest> core = local_request(request);
    if (!core.ok()) return to_public(core.status());
    const auto sampler = tet::ShapeSampler::make(*std::move(shape), *std::move(core));
    if (!sampler.ok()) return to_public(sampler.status());
    absl::StatusOr<tet::PointSamples> samples = absl::UnknownError("not sampled");
    tet::TaskPool pool(options.threads);
    pool.run([&] { samples = sample_steps(*sampler, *places, options, work.cancellation()); });
    if (!samples.ok()) return to_public(samples.status());
    return public_samples(*std::move(samples));
  });
}

template <class Solid>
Result<PointSamples> samples_there(const Client::Impl& client,
                                   const Solid& solid,
                                   std::span<const double> points,
                                   const Request& request,
                                   const WorkOptions& options) {
  return guarded([&]() -> Result<PointSamples> {
    const Work work(options);
    const auto places = places_of(points);
    if (!places.ok()) return to_public(places.status());
    const auto message = message_of(*client.meshes, solid, request, work.cancellation());
    if (!message.ok()) return to_public(message.status());
    const auto tell = [&](std::uint64_t done, std::uint64_t total) {
      if (!options.progress || total == 0) return;
      options.progress(static_cast<double>(done) / static_cast<double>(total));
    };
    absl::StatusOr<tet::PointSamples> samples =
        tet::sample_there(*client.connection, *message, *places, tell, work.cancellation());
    if (!samples.ok()) return to_public(samples.status());
    return public_samples(*std::move(samples));
  });
}

}  // namespace

Result<PointSamples> sample(const Volume& volume,
                            std::span<const double> points,
                            const Request& request,
                            const WorkOptions& options) {
  return sample_of(volume, points, request, options);
}
Result<PointSamples> sample(const Scene& scene,
                            std::span<const double> points,
                            const Request& request,
                            const WorkOptions& options) {
  return sample_of(scene, points, request, options);
}

Result<PointSamples> Client::sample(const StoredVolume& volume,
                                    std::span<const double> points,
                                    const Request& request,
                                    const WorkOptions& options) const {
  return samples_there(*impl_, volume, points, request, options);
}
Result<PointSamples> Client::sample(const Scene& scene,
                                    std::span<const double> points,
                                    const Request& request,
                                    const WorkOptions& options) const {
  return samples_there(*impl_, scene, points, request, options);
}

}  // namespace tetstream
