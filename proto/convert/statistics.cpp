#include "proto/convert/statistics.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "proto/convert/counts.h"
#include "proto/convert/points.h"

namespace tet {
namespace {

absl::Status wrong(const std::string& message) { return absl::InvalidArgumentError(message); }

struct NamedCount {
  const char* field;
  std::int64_t count;
};

absl::Status check_all(std::initializer_list<NamedCount> counts) {
  for (const auto& [field, count] : counts) {
    if (is_count(count)) continue;
    return wrong(absl::StrFormat("%s %d is not from 0 to %d", field, count, kMaxCount));
  }
  return absl::OkStatus();
}

struct NamedNumber {
  const char* field;
  double number;
};

absl::Status check_finite(std::initializer_list<NamedNumber> numbers) {
  for (const auto& [field, number] : numbers) {
    if (!std::isfinite(number)) return wrong(absl::StrCat(field, " is not finite"));
  }
  return absl::OkStatus();
}

absl::StatusOr<ThinWalls::Region> region_of(const v1::ThinRegion& message) {
  if (!is_finite(message.box())) return wrong("box is not finite");
  absl::Status status = check_all(
      {{"inside_spots", message.inside_spots()}, {"outside_spots", message.outside_spots()}});
  if (!status.ok()) return status;
  return ThinWalls::Region{from_proto(message.box()), unsigned_count(message.inside_spots()),
                           unsigned_count(message.outside_spots())};
}

}  // namespace

void to_proto(const QualityStats& stats, v1::QualityStats& message) {
  message.set_min_dihedral_deg(stats.min_dihedral_deg);
  message.set_max_dihedral_deg(stats.max_dihedral_deg);
  message.set_volume(stats.volume);
  for (const std::uint64_t count : stats.histogram) {
    message.add_dihedral_histogram(signed_count(count));
  }
}

void to_proto(const BoundaryTopology& boundary, v1::BoundaryTopology& message) {
  message.set_triangles(signed_count(boundary.triangles));
  message.set_vertices(signed_count(boundary.vertices));
  message.set_components(signed_count(boundary.components));
  message.set_euler_characteristic(boundary.euler_characteristic);
  message.set_non_manifold_edges(signed_count(boundary.non_manifold_edges));
  message.set_non_manifold_vertices(signed_count(boundary.non_manifold_vertices));
  message.set_restored_nodes(signed_count(boundary.restored_nodes));
}

void to_proto(const ThinWalls& walls, v1::ThinWalls& message) {
  message.set_inside_spots(signed_count(walls.inside));
  message.set_outside_spots(signed_count(walls.outside));
  message.set_region_count(signed_count(walls.region_count));
  for (const ThinWalls::Region& region : walls.regions) {
    v1::ThinRegion& listed = *message.add_regions();
    to_proto(region.box, *listed.mutable_box());
    listed.set_inside_spots(signed_count(region.inside));
    listed.set_outside_spots(signed_count(region.outside));
  }
  message.set_thickness(walls.thickness);
  message.set_suggested_spacing(walls.suggested_spacing);
}

void to_proto(const Improvement& improvement, v1::Improvement& message) {
  message.set_min_dihedral_before_deg(improvement.min_dihedral_before_deg);
  message.set_max_dihedral_before_deg(improvement.max_dihedral_before_deg);
  message.set_moved_vertices(signed_count(improvement.moved_vertices));
  message.set_seconds(improvement.seconds);
}

absl::StatusOr<QualityStats> from_proto(const v1::QualityStats& message) {
  if (message.dihedral_histogram_size() != QualityStats::kBins) {
    return wrong(absl::StrFormat("dihedral_histogram has %d numbers, not %d",
                                 message.dihedral_histogram_size(), QualityStats::kBins));
  }
  absl::Status status = check_finite({{"min_dihedral_deg", message.min_dihedral_deg()},
                                      {"max_dihedral_deg", message.max_dihedral_deg()},
                                      {"volume", message.volume()}});
  for (const std::int64_t count : message.dihedral_histogram()) {
    if (status.ok()) status = check_all({{"dihedral_histogram", count}});
  }
  if (!status.ok()) return status;
  QualityStats stats;
  stats.min_dihedral_deg = message.min_dihedral_deg();
  stats.max_dihedral_deg = message.max_dihedral_deg();
  stats.volume = message.volume();
  std::ranges::transform(message.dihedral_histogram(), stats.histogram.begin(), unsigned_count);
  return stats;
}

absl::StatusOr<BoundaryTopology> from_proto(const v1::BoundaryTopology& message) {
  const absl::Status status =
      check_all({{"triangles", message.triangles()},
                 {"vertices", message.vertices()},
                 {"components", message.components()},
                 {"non_manifold_edges", message.non_manifold_edges()},
                 {"non_manifold_vertices", message.non_manifold_vertices()},
                 {"restored_nodes", message.restored_nodes()}});
  if (!status.ok()) return status;
  const std::int64_t euler = message.euler_characteristic();
  if (euler < -kMaxCount || euler > kMaxCount) {
    return wrong(absl::StrFormat("euler_characteristic %d is not from -%d to %d", euler,
                                 kMaxCount, kMaxCount));
  }
  return BoundaryTopology{
      .triangles = unsigned_count(message.triangles()),
      .vertices = unsigned_count(message.vertices()),
      .components = unsigned_count(message.components()),
      .euler_characteristic = euler,
      .non_manifold_edges = unsigned_count(message.non_manifold_edges()),
      .non_manifold_vertices = unsigned_count(message.non_manifold_vertices()),
      .restored_nodes = unsigned_count(message.restored_nodes())};
}

absl::StatusOr<ThinWalls> from_proto(const v1::ThinWalls& message) {
  absl::Status status = check_all({{"inside_spots", message.inside_spots()},
                                   {"outside_spots", message.outside_spots()},
                                   {"region_count", message.region_count()}});
  if (status.ok()) {
    status = check_finite({{"thickness", message.thickness()},
                           {"suggested_spacing", message.suggested_spacing()}});
  }
  if (!status.ok()) return status;
  ThinWalls walls;
  walls.inside = unsigned_count(message.inside_spots());
  walls.outside = unsigned_count(message.outside_spots());
  walls.region_count = unsigned_count(message.region_count());
  for (const v1::ThinRegion& listed : message.regions()) {
    const auto region = region_of(listed);
    if (!region.ok()) {
      return wrong(
          absl::StrFormat("regions[%d].%s", walls.regions.size(), region.status().message()));
    }
    walls.regions.push_back(*region);
  }
  walls.thickness = message.thickness();
  walls.suggested_spacing = message.suggested_spacing();
  return walls;
}

absl::StatusOr<Improvement> from_proto(const v1::Improvement& message) {
  absl::Status status = check_all({{"moved_vertices", message.moved_vertices()}});
  if (status.ok()) {
    status = check_finite({{"min_dihedral_before_deg", message.min_dihedral_before_deg()},
                           {"max_dihedral_before_deg", message.max_dihedral_before_deg()},
                           {"seconds", message.seconds()}});
  }
  if (!status.ok()) return status;
  return Improvement{.min_dihedral_before_deg = message.min_dihedral_before_deg(),
                     .max_dihedral_before_deg = message.max_dihedral_before_deg(),
                     .moved_vertices = unsigned_count(message.moved_vertices()),
                     .seconds = message.seconds()};
}

}  // namespace tet
