#include "proto/convert/fidelity.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <utility>

#include <absl/strings/str_format.h>

#include "proto/convert/counts.h"
#include "proto/convert/points.h"

namespace tet {
namespace {

absl::Status wrong(std::string_view field, std::string_view what) {
  return absl::InvalidArgumentError(absl::StrFormat("%s %s", field, what));
}

bool are_counts(const google::protobuf::RepeatedField<std::int64_t>& numbers) {
  return std::ranges::all_of(numbers, [](std::int64_t number) { return is_count(number); });
}

void to_proto(const SurfaceDistance& distance, v1::SurfaceDistance& message) {
  message.set_max(distance.max);
  message.set_rms(distance.rms);
  to_proto(distance.at, *message.mutable_at());
  message.set_samples(signed_count(distance.samples));
}

void to_proto(const Fidelity& fidelity, v1::Fidelity& message) {
  message.set_spacing(fidelity.spacing);
  to_proto(fidelity.to_surface, *message.mutable_mesh_to_surface());
  to_proto(fidelity.from_surface, *message.mutable_surface_to_mesh());
  message.set_mesh_area(fidelity.mesh_area);
  message.set_surface_area(fidelity.surface_area);
  message.set_mesh_volume(fidelity.mesh_volume);
  if (fidelity.enclosed_volume) message.set_enclosed_volume(*fidelity.enclosed_volume);
}

void to_proto(const RatioSummary& ratio, v1::RatioStats& message) {
  message.set_min(ratio.min);
  message.set_mean(ratio.mean);
  message.set_max(ratio.max);
  for (const std::uint64_t count : ratio.histogram) {
    message.add_histogram(signed_count(count));
  }
}

void to_proto(const ShapeSummary& shapes, v1::ShapeStats& message) {
  to_proto(shapes.scaled_jacobian, *message.mutable_scaled_jacobian());
  to_proto(shapes.radius_ratio, *message.mutable_radius_ratio());
  to_proto(shapes.edge_ratio, *message.mutable_edge_ratio());
  message.set_shortest_edge(shapes.shortest_edge);
  message.set_longest_edge(shapes.longest_edge);
  message.set_not_positive(signed_count(shapes.not_positive));
}

absl::StatusOr<SurfaceDistance> distance_of(const v1::SurfaceDistance& message,
                                            std::string_view field) {
  const auto& at = message.at();
  for (const double number : {message.max(), message.rms(), at.x(), at.y(), at.z()}) {
    if (!std::isfinite(number)) return wrong(field, "has a number that is not finite");
  }
  if (!is_count(message.samples())) return wrong(field, "has an impossible count of samples");
  return SurfaceDistance{message.max(), message.rms(), from_proto(at),
                         unsigned_count(message.samples())};
}

absl::StatusOr<Fidelity> fidelity_of(const v1::Fidelity& message) {
  const auto to_surface = distance_of(message.mesh_to_surface(), "mesh_to_surface");
  if (!to_surface.ok()) return to_surface.status();
  const auto from_surface = distance_of(message.surface_to_mesh(), "surface_to_mesh");
  if (!from_surface.ok()) return from_surface.status();
  for (const double number : {message.mesh_area(), message.surface_area(),
                              message.mesh_volume(), message.enclosed_volume()}) {
    if (!std::isfinite(number)) return wrong("area or volume", "is not finite");
  }
  if (!(message.spacing() > 0 && std::isfinite(message.spacing()))) {
    return wrong("spacing", "is not positive and finite");
  }
  Fidelity fidelity{.spacing = message.spacing(),
                    .to_surface = *to_surface,
                    .from_surface = *from_surface,
                    .mesh_area = message.mesh_area(),
                    .surface_area = message.surface_area(),
                    .mesh_volume = message.mesh_volume(),
                    .enclosed_volume = {}};
  if (message.has_enclosed_volume()) fidelity.enclosed_volume = message.enclosed_volume();
  return fidelity;
}

absl::StatusOr<RatioSummary> ratio_of(const v1::RatioStats& message, std::string_view field) {
  RatioSummary ratio{message.min(), message.mean(), message.max()};
  for (const double number : {ratio.min, ratio.mean, ratio.max}) {
    if (!std::isfinite(number)) return wrong(field, "has a number that is not finite");
  }
  if (message.histogram_size() != static_cast<int>(ratio.histogram.size()) ||
      !are_counts(message.histogram())) {
    return wrong(field,
                 absl::StrFormat("has no histogram of %d counts", ratio.histogram.size()));
  }
  std::ranges::transform(message.histogram(), ratio.histogram.begin(), unsigned_count);
  return ratio;
}

absl::StatusOr<ShapeSummary> shapes_of(const v1::ShapeStats& message) {
  const auto jacobian = ratio_of(message.scaled_jacobian(), "shapes.scaled_jacobian");
  if (!jacobian.ok()) return jacobian.status();
  const auto radius = ratio_of(message.radius_ratio(), "shapes.radius_ratio");
  if (!radius.ok()) return radius.status();
  const auto edge = ratio_of(message.edge_ratio(), "shapes.edge_ratio");
  if (!edge.ok()) return edge.status();
  if (!std::isfinite(message.shortest_edge()) || !std::isfinite(message.longest_edge())) {
    return wrong("shapes", "has an edge that is not finite");
  }
  if (!is_count(message.not_positive())) return wrong("shapes.not_positive", "is no count");
  return ShapeSummary{*jacobian,
                      *radius,
                      *edge,
                      message.shortest_edge(),
                      message.longest_edge(),
                      unsigned_count(message.not_positive())};
}

}  // namespace

void to_proto(const MeshFidelity& fidelity, v1::MeshTrailer& trailer) {
  for (const Fidelity& part : fidelity.parts) to_proto(part, *trailer.add_fidelity());
  to_proto(fidelity.shapes, *trailer.mutable_shapes());
}

absl::StatusOr<std::optional<MeshFidelity>> fidelity_of(const v1::MeshTrailer& trailer) {
  if (trailer.fidelity().empty()) return std::nullopt;
  MeshFidelity told;
  for (const v1::Fidelity& message : trailer.fidelity()) {
    const auto part = fidelity_of(message);
    if (!part.ok()) {
      return absl::InvalidArgumentError(
          absl::StrFormat("fidelity[%d]: %s", told.parts.size(), part.status().message()));
    }
    told.parts.push_back(*part);
  }
  auto shapes = shapes_of(trailer.shapes());
  if (!shapes.ok()) return shapes.status();
  told.shapes = *std::move(shapes);
  return told;
}

}  // namespace tet
