#include "core/mesh/tet_shapes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "core/base/parallel.h"
#include "core/base/tet_geometry.h"
#include "core/mesh/tets_per_range.h"

namespace tet {
namespace {

double norm(const Vector& v) noexcept { return std::sqrt(dot(v, v)); }

/// Three times the radius of the ball within to that of the ball around. The latter's is
/// |d^2 (b x c) + b^2 (c x d) + c^2 (d x b)| / 2J of the edges b, c, d from one corner; the
/// former's J / 2 to the areas, where J is six volumes.
double radius_ratio(const std::array<WorldPoint, 4>& place, double jacobian) noexcept {
  const Vector b = from_to(place[0], place[1]), c = from_to(place[0], place[2]),
               d = from_to(place[0], place[3]);
  const Vector bc = cross(b, c), cd = cross(c, d), db = cross(d, b);
  const double bb = dot(b, b), cc = dot(c, c), dd = dot(d, d);
  const Vector middle{dd * bc.x + bb * cd.x + cc * db.x, dd * bc.y + bb * cd.y + cc * db.y,
                      dd * bc.z + bb * cd.z + cc * db.z};
  double twice_areas = 0;
  for (const Vector& normal : face_normals(place[0], place[1], place[2], place[3])) {
    twice_areas += norm(normal);
  }
  const double denominator = twice_areas * norm(middle);
  if (!(denominator > 0)) return 0;
  return std::min(1.0, 6 * jacobian * jacobian / denominator);
}

/// Edges by the corners that they join.
constexpr std::array<std::array<std::size_t, 2>, 6> kEdges{
    {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
/// The edges at each corner.
constexpr std::array<std::array<std::size_t, 3>, 4> kEdgesAt{
    {{0, 1, 2}, {0, 3, 4}, {1, 3, 5}, {2, 4, 5}}};

bool is_worse(const WorstTet& a, const WorstTet& b) noexcept {
  return std::tie(a.shape.scaled_jacobian, a.tet) < std::tie(b.shape.scaled_jacobian, b.tet);
}

WorldPoint middle_of(const std::array<WorldPoint, 4>& p, const WorldPoint& origin) noexcept {
  return {origin.x + (p[0].x + p[1].x + p[2].x + p[3].x) / 4,
          origin.y + (p[0].y + p[1].y + p[2].y + p[3].y) / 4,
          origin.z + (p[0].z + p[1].z + p[2].z + p[3].z) / 4};
}

ShapeStats measure_range(const TetMesh& mesh, std::uint64_t begin, std::uint64_t end) {
  const MeshView view = mesh.view();
  ShapeStats stats;
  for (std::uint64_t tet = begin; tet < end; ++tet) {
    stats.add(tet, view.stored_places(tet), mesh.header);
  }
  return stats;
}

}  // namespace

ShapeRatios shape_of(const std::array<WorldPoint, 4>& place) noexcept {
  ShapeRatios shape;
  double shortest = HUGE_VAL, longest = 0;
  for (std::size_t e = 0; e < kEdges.size(); ++e) {
    const double edge = norm(from_to(place[kEdges[e][0]], place[kEdges[e][1]]));
    shape.edges[e] = edge;
    shortest = std::min(shortest, edge);
    longest = std::max(longest, edge);
  }
  if (!(shortest > 0)) return shape;
  const Vector b = from_to(place[0], place[1]), c = from_to(place[0], place[2]),
               d = from_to(place[0], place[3]);
  const double jacobian = dot(cross(b, c), d);
  double largest = 0;
  for (const auto& [i, j, k] : kEdgesAt) {
    largest = std::max(largest, shape.edges[i] * shape.edges[j] * shape.edges[k]);
  }
  shape.scaled_jacobian = std::clamp(std::numbers::sqrt2 * jacobian / largest, -1.0, 1.0);
  shape.radius_ratio = radius_ratio(place, jacobian);
  shape.edge_ratio = shortest / longest;
  return shape;
}

void RatioStats::add(double ratio) noexcept {
  min = std::min(min, ratio);
  max = std::max(max, ratio);
  sum_units += std::llrint(ratio / kUnit);
  ++count;
  const double bin = std::clamp(ratio, 0.0, 1.0) * kBins;
  ++histogram[std::min(static_cast<std::size_t>(bin), kBins - 1)];
}

void RatioStats::add(const RatioStats& other) noexcept {
  min = std::min(min, other.min);
  max = std::max(max, other.max);
  sum_units += other.sum_units;
  count += other.count;
  for (std::size_t b = 0; b < kBins; ++b) histogram[b] += other.histogram[b];
}

void LengthStats::add(double length, double spacing) noexcept {
  min = empty_ ? length : std::min(min, length);
  max = empty_ ? length : std::max(max, length);
  empty_ = false;
  const double octave = length > 0 ? std::log2(length / spacing) : kFirstOctave;
  const double bin = (octave - kFirstOctave) * kBinsPerOctave;
  ++histogram[static_cast<std::size_t>(std::clamp(bin, 0.0, kBins - 1.0))];
}

void LengthStats::add(const LengthStats& other) noexcept {
  if (other.empty_) return;
  min = empty_ ? other.min : std::min(min, other.min);
  max = empty_ ? other.max : std::max(max, other.max);
  empty_ = false;
  for (std::size_t b = 0; b < kBins; ++b) histogram[b] += other.histogram[b];
}

void ShapeStats::add(std::uint64_t tet,
                     const std::array<WorldPoint, 4>& place,
                     const MeshHeader& header) {
  const ShapeRatios shape = shape_of(place);
  scaled_jacobian.add(shape.scaled_jacobian);
  radius_ratio.add(shape.radius_ratio);
  edge_ratio.add(shape.edge_ratio);
  for (const double edge : shape.edges) edges.add(edge, header.spacing);
  if (!(shape.scaled_jacobian > 0)) ++not_positive;
  const bool full = worst.size() == kWorst;
  const WorstTet one{tet, shape, middle_of(place, header.origin)};
  if (full && !is_worse(one, worst.back())) return;
  if (full) worst.pop_back();
  worst.insert(std::ranges::upper_bound(worst, one, is_worse), one);
}

void ShapeStats::add(const ShapeStats& other) {
  scaled_jacobian.add(other.scaled_jacobian);
  radius_ratio.add(other.radius_ratio);
  edge_ratio.add(other.edge_ratio);
  edges.add(other.edges);
  not_positive += other.not_positive;
  std::vector<WorstTet> merged;
  std::ranges::merge(worst, other.worst, std::back_inserter(merged), is_worse);
  if (merged.size() > kWorst) merged.resize(kWorst);
  worst = std::move(merged);
}

ShapeStats measure_shapes(const TetMesh& mesh) {
  const std::uint64_t tets = mesh.header.tet_count;
  std::vector<ShapeStats> ranges((tets + kTetsPerRange - 1) / kTetsPerRange);
  for_each_index(ranges.size(), [&](std::size_t r) {
    const std::uint64_t begin = r * kTetsPerRange;
    ranges[r] = measure_range(mesh, begin, std::min(begin + kTetsPerRange, tets));
  });
  ShapeStats total;
  for (const ShapeStats& range : ranges) total.add(range);
  return total;
}

}  // namespace tet
