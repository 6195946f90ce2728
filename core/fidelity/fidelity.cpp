#include "core/fidelity/fidelity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/loop_in_order.h"
#include "core/base/parallel.h"
#include "core/base/tet_geometry.h"
#include "core/fidelity/measured_mesh.h"
#include "core/fidelity/nearest_zero.h"
#include "core/fidelity/surface_triangles.h"
#include "core/fidelity/tet_sums.h"
#include "core/fidelity/true_surface.h"
#include "core/field/find_bricks.h"
#include "core/mesh/box_tree.h"
#include "core/mesh/tets_per_range.h"
#include "core/mesh/triangle_distance.h"
#include "core/plan/prepared_mesh.h"

namespace tet {
namespace {

constexpr std::size_t kPointsPerTriangle = 7;
/// So many triangles are looked at because they are likely to be the worst.
constexpr std::size_t kSuspects = 512;
constexpr std::size_t kPerRange = 64;

using Place = std::array<WorldPoint, 3>;

WorldPoint mean_of(const WorldPoint& a, const WorldPoint& b) noexcept {
  return {(a.x + b.x) / 2, (a.y + b.y) / 2, (a.z + b.z) / 2};
}

WorldPoint middle_of(const Place& t) noexcept {
  return {(t[0].x + t[1].x + t[2].x) / 3, (t[0].y + t[1].y + t[2].y) / 3,
          (t[0].z + t[1].z + t[2].z) / 3};
}

double area_of(const Place& t) noexcept {
  const Vector normal = cross(from_to(t[0], t[1]), from_to(t[0], t[2]));
  return std::sqrt(dot(normal, normal)) / 2;
}

/// A rule that is exact for cubes: corners, middles of sides, and the middle, with their
/// shares.
struct RulePoint {
  WorldPoint at;
  double share = 0;
};
std::array<RulePoint, kPointsPerTriangle> rule_on(const Place& t) noexcept {
  constexpr double kCorner = 1.0 / 20, kSide = 2.0 / 15, kMiddle = 9.0 / 20;
  return {{{t[0], kCorner},
           {t[1], kCorner},
           {t[2], kCorner},
           {mean_of(t[0], t[1]), kSide},
           {mean_of(t[1], t[2]), kSide},
           {mean_of(t[2], t[0]), kSide},
           {middle_of(t), kMiddle}}};
}

/// What was found of one sample, or of several.
struct Found {
  double largest = 0, squares = 0, weight = 0;
  WorldPoint at;

  void add(double distance, double share, const WorldPoint& place) noexcept {
    squares += share * distance * distance;
    weight += share;
    if (distance <= largest) return;
    largest = distance;
    at = place;
  }
  void add(const Found& other) noexcept {
    squares += other.squares;
    weight += other.weight;
    if (other.largest <= largest) return;
    largest = other.largest;
    at = other.at;
  }
};

SurfaceDistance distance_of(const std::vector<Found>& all, std::uint64_t samples) {
  Found sum;
  for (const Found& found : all) sum.add(found);
  const double mean = sum.weight > 0 ? sum.squares / sum.weight : 0;
  return {sum.largest, std::sqrt(mean), sum.at, samples};
}

/// A mesh's surface, and where it is.
struct MeshSurface {
  std::vector<Place> triangles;
  double area = 0;
};

MeshSurface mesh_surface(const MeasuredMesh& mesh,
                         std::uint64_t first_vertex,
                         std::uint64_t vertex_count,
                         const Cancellation& cancellation) {
  const WorldPoint& origin = mesh.header.origin;
  const auto vertex = [&](std::uint64_t i) {
    const WorldPoint stored = mesh.places.stored_position(i);
    return WorldPoint{origin.x + stored.x, origin.y + stored.y, origin.z + stored.z};
  };
  MeshSurface surface;
  for_each_in_order(mesh.surface.size(), cancellation, [&](std::uint64_t i) {
    const Triangle& t = mesh.surface[i];
    if (t[0] < first_vertex || t[0] - first_vertex >= vertex_count) return;
    surface.triangles.push_back({vertex(t[0]), vertex(t[1]), vertex(t[2])});
    surface.area += area_of(surface.triangles.back());
  });
  return surface;
}

WorldBox box_of(const Place& t) noexcept {
  const auto& [a, b, c] = t;
  return {{std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y}), std::min({a.z, b.z, c.z})},
          {std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y}), std::max({a.z, b.z, c.z})}};
}

BoxTree tree_of(const std::vector<Place>& triangles) {
  std::vector<WorldBox> boxes(triangles.size());
  std::ranges::transform(triangles, boxes.begin(), box_of);
  return BoxTree(boxes);
}

BoxTree tree_of(const std::vector<SurfacePoint>& points) {
  std::vector<WorldBox> boxes(points.size());
  std::ranges::transform(points, boxes.begin(), [](const SurfacePoint& p) {
    return WorldBox{p.at, p.at};
  });
  return BoxTree(boxes);
}

/// The triangles that are sampled: so many of all, spread evenly, and those in whose middle phi
/// is the farthest from zero, which have no share in the mean.
struct ChosenTriangles {
  std::vector<std::size_t> even, suspects;
};

/// Once cancelled any: phi of a scene may take a tenth of a millisecond a point.
ChosenTriangles choose(const MeshSurface& surface,
                       const PhiField& field,
                       double spacing,
                       const Cancellation& cancellation) {
  constexpr std::size_t kBetweenLooks = 256;
  const std::size_t count = surface.triangles.size();
  ChosenTriangles chosen;
  const std::size_t most = kFidelitySamples / kPointsPerTriangle;
  for (std::size_t i = 0; i < std::min(count, most); ++i) {
    chosen.even.push_back(count <= most ? i : i * count / most);
  }
  if (count <= most) return chosen;
  std::vector<std::pair<double, std::size_t>> off(count);
  for_each_range(count, 4096, [&](std::size_t begin, std::size_t end) {
    NearestZero zero(field, spacing);
    for (std::size_t i = begin; i < end; ++i) {
      if ((i - begin) % kBetweenLooks == 0 && cancellation.requested()) return;
      off[i] = {-std::abs(zero.phi_at(middle_of(surface.triangles[i]))), i};
    }
  });
  if (cancellation.requested()) return chosen;
  std::ranges::nth_element(off, off.begin() + kSuspects);
  std::sort(off.begin(), off.begin() + kSuspects);
  for (std::size_t i = 0; i < kSuspects; ++i) chosen.suspects.push_back(off[i].second);
  return chosen;
}

/// Measures from the mesh's surface.
class FromMesh {
 public:
  FromMesh(const PhiField& field, double spacing, const TrueSurface& truth)
      : field_(field), spacing_(spacing), truth_(truth), tree_(tree_of(truth.points)) {}

  /// What is found is of no use once it is cancelled.
  SurfaceDistance measure(const MeshSurface& surface, const Cancellation& cancellation) const {
    const ChosenTriangles chosen = choose(surface, field_, spacing_, cancellation);
    const auto& even = chosen.even;
    const auto& suspects = chosen.suspects;
    std::vector<Found> found(even.size() + suspects.size());
    for_each_range(found.size(), kPerRange, [&](std::size_t begin, std::size_t end) {
      NearestZero zero(field_, spacing_);
      for (std::size_t i = begin; i < end; ++i) {
        if (cancellation.requested()) return;  // one takes hundreds of points of phi
        const bool counts = i < even.size();
        const std::size_t triangle = counts ? even[i] : suspects[i - even.size()];
        found[i] = measure(surface.triangles[triangle], counts ? 1 : 0, zero);
      }
    });
    return distance_of(found, kPointsPerTriangle * found.size());
  }

 private:
  Found measure(const Place& triangle, double weight, NearestZero& zero) const noexcept {
    Found found;
    const double area = weight * area_of(triangle);
    for (const RulePoint& point : rule_on(triangle)) {
      found.add(distance(point.at, zero), area * point.share, point.at);
    }
    return found;
  }

  /// The least of what is found, as each is the distance to some point of the surface.
  double distance(const WorldPoint& p, NearestZero& zero) const noexcept {
    const double down = zero.distance(p).value_or(std::numeric_limits<double>::infinity());
    const BoxTree::Nearest near = tree_.nearest(
        p,
        [&](std::uint32_t i) {
          const Vector way = from_to(truth_.points[i].at, p);
          return dot(way, way);
        },
        down * down);
    const double least = std::min(down, std::sqrt(near.squared_distance));
    return std::isfinite(least) ? least : 0;  // phi has no surface at all
  }

  const PhiField& field_;
  double spacing_;
  const TrueSurface& truth_;
  BoxTree tree_;
};

SurfaceDistance measure_to_mesh(const TrueSurface& truth,
                                const MeshSurface& surface,
                                const Cancellation& cancellation) {
  const BoxTree tree = tree_of(surface.triangles);
  if (tree.size() == 0) return {};
  std::vector<Found> found(truth.points.size());
  for_each_range(found.size(), kPerRange, [&](std::size_t begin, std::size_t end) {
    if (cancellation.requested()) return;
    for (std::size_t i = begin; i < end; ++i) {
      const WorldPoint& at = truth.points[i].at;
      const BoxTree::Nearest near = tree.nearest(
          at, [&](std::uint32_t t) { return squared_distance(at, surface.triangles[t]); });
      found[i].add(std::sqrt(near.squared_distance), truth.points[i].area, at);
    }
  });
  return distance_of(found, found.size());
}

/// What a true surface is looked for in: where the lattice is coarser than the voxels, these.
struct FieldToSample {
  PhiField field;
  std::vector<BrickCoord> bricks;
  std::optional<BrickBox> domain;
};

absl::StatusOr<FieldToSample> field_to_sample(const PreparedMesh& prepared,
                                              const Cancellation& cancellation) {
  FieldToSample sampled{prepared.field, prepared.bricks.near_surface, prepared.space.domain};
  // Within a domain the lattice of the mesh tells where it ends.
  if (!prepared.field.coarser_than_voxels() || sampled.domain) return sampled;
  sampled.field.spacing_voxels = 1;
  absl::StatusOr<FoundBricks> found =
      find_bricks(sampled.field, kMaxSurfaceBricks, cancellation);
  if (!found.ok()) return found.status();
  sampled.bricks = std::move(found->near_surface);
  return sampled;
}

/// The mesh, or one grid's part of it.
struct MeasuredPart {
  std::uint64_t first_vertex = 0, vertex_count = 0;
  double volume = 0;
};

absl::StatusOr<Fidelity> measure_part(const MeasuredMesh& mesh,
                                      const MeasuredPart& part,
                                      const PreparedMesh& prepared,
                                      const Cancellation& cancellation) {
  const absl::StatusOr<FieldToSample> sampled = field_to_sample(prepared, cancellation);
  if (!sampled.ok()) return sampled.status();
  const absl::StatusOr<TrueSurface> truth = find_true_surface(
      sampled->field, sampled->bricks, sampled->domain, kFidelitySamples, cancellation);
  if (!truth.ok()) return truth.status();
  const MeshSurface surface =
      mesh_surface(mesh, part.first_vertex, part.vertex_count, cancellation);
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  const double spacing = prepared.asked.spacing;
  Fidelity fidelity{
      .spacing = spacing,
      .to_surface = FromMesh(sampled->field, spacing, *truth).measure(surface, cancellation),
      .from_surface = measure_to_mesh(*truth, surface, cancellation),
      .mesh_area = surface.area,
      .surface_area = truth->area,
      .mesh_volume = part.volume,
      .enclosed_volume = truth->enclosed_volume};
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  return fidelity;
}

/// In ranges of tets: sums do not depend on how they are cut.
TetSums sums_of(const TetMesh& mesh) {
  const MeshView view = mesh.view();
  const std::uint64_t tets = mesh.header.tet_count;
  std::vector<TetSums> ranges((tets + kTetsPerRange - 1) / kTetsPerRange, TetSums(mesh.header));
  for_each_index(ranges.size(), [&](std::size_t r) {
    const std::uint64_t begin = r * kTetsPerRange;
    for (std::uint64_t i = begin; i < std::min(begin + kTetsPerRange, tets); ++i) {
      ranges[r].add(i, view.stored_places(i), mesh.region(i));
    }
  });
  TetSums all(mesh.header);
  for (const TetSums& range : ranges) all.add(range);
  return all;
}

}  // namespace

double Fidelity::hausdorff() const noexcept {
  return std::max(to_surface.max, from_surface.max);
}

absl::StatusOr<std::vector<Fidelity>> measure_surface(const MeasuredMesh& mesh,
                                                      const Shape& shape,
                                                      const MeshRequest& request,
                                                      const Cancellation& cancellation) {
  const MeshRequest asked = request_for_phi(request);
  std::vector<Fidelity> all;
  const auto measure = [&](const Shape& one, const MeasuredPart& part) {
    const auto prepared = prepare_mesh(one, asked, MeshLimits{}, cancellation);
    if (!prepared.ok()) return prepared.status();
    auto fidelity = measure_part(mesh, part, *prepared, cancellation);
    if (!fidelity.ok()) return fidelity.status();
    if (request.box) fidelity->enclosed_volume.reset();
    all.push_back(*fidelity);
    return absl::OkStatus();
  };
  const MeshHeader& header = mesh.header;
  if (const GridList* grids = grids_of(shape)) {
    if (grids->size() != header.parts.size()) {
      return absl::InvalidArgumentError("the mesh is of other grids");
    }
    for (std::size_t i = 0; i < grids->size(); ++i) {
      const MeshPart& part = header.parts[i];
      const absl::Status status =
          measure((*grids)[i], {part.first_vertex, part.vertex_count, mesh.volumes[i]});
      if (!status.ok()) return status;
    }
    return all;
  }
  const absl::Status status = measure(shape, {0, header.vertex_count, mesh.volumes.front()});
  if (!status.ok()) return status;
  return all;
}

absl::StatusOr<MeshFidelity> fidelity_of(const TetMesh& mesh,
                                         const Shape& shape,
                                         const MeshRequest& request,
                                         const Cancellation& cancellation) {
  const std::vector<Triangle> surface = surface_triangles(mesh);
  const TetSums sums = sums_of(mesh);
  auto parts = measure_surface({mesh.header, mesh.view(), surface, sums.volumes()}, shape,
                               request, cancellation);
  if (!parts.ok()) return parts.status();
  return MeshFidelity{*std::move(parts), summary_of(sums.shapes())};
}

absl::StatusOr<std::vector<Fidelity>> measure_fidelity(const TetMesh& mesh,
                                                       const Shape& shape,
                                                       const MeshRequest& request,
                                                       const Cancellation& cancellation) {
  auto all = fidelity_of(mesh, shape, request, cancellation);
  if (!all.ok()) return all.status();
  return std::move(all->parts);
}

}  // namespace tet
