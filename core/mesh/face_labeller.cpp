#include "core/mesh/face_labeller.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "core/base/parallel.h"
#include "core/scene/waves.h"

namespace tet {
namespace {

Vector vector_to(const WorldPoint& p) noexcept { return {p.x, p.y, p.z}; }

Vector unit(const Vector& v) noexcept {
  const double length = std::sqrt(dot(v, v));
  return {v.x / length, v.y / length, v.z / length};
}

double distance_squared(const Vector& a, const Vector& b) noexcept { return dot(a - b, a - b); }

WorldPoint middle_of(const FacePlace& face) noexcept {
  const auto& [a, b, c] = face;
  return {(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3, (a.z + b.z + c.z) / 3};
}

bool is_in(const WorldBox& box, const WorldPoint& p) noexcept {
  const auto& [min, max] = box;
  return min.x <= p.x && p.x <= max.x && min.y <= p.y && p.y <= max.y && min.z <= p.z &&
         p.z <= max.z;
}

bool is_in(const FaceRegion::Ball& ball, const WorldPoint& p) noexcept {
  return distance_squared(vector_to(p), vector_to(ball.centre)) <= ball.radius * ball.radius;
}

/// `along` leads from one end towards the other, one long.
bool is_in(const FaceRegion::Cylinder& cylinder,
           const Vector& along,
           double length,
           const WorldPoint& p) noexcept {
  const Vector from = vector_to(p) - vector_to(cylinder.start);
  const double at = dot(from, along);
  const Vector foot{at * along.x, at * along.y, at * along.z};
  return at >= 0 && at <= length &&
         distance_squared(from, foot) <= cylinder.radius * cylinder.radius;
}

/// Whether the cosine of the angle between a face's normal and a direction is at least this.
bool is_facing(const Vector& direction, double least_cos, const FacePlace& face) noexcept {
  const Vector a = vector_to(face[0]);
  const Vector normal = cross(vector_to(face[1]) - a, vector_to(face[2]) - a);
  return dot(normal, direction) >= least_cos * std::sqrt(dot(normal, normal));
}

/// The instructions of all copies of a node.
std::vector<bool> instructions_of(const std::string& node, const Scene& scene) {
  std::vector<bool> own(scene.program.size());
  for (const scene::NodeRun& run : scene.runs) {
    if (scene.node_names[run.node] != node) continue;
    std::fill(own.begin() + run.begin, own.begin() + run.end, true);
  }
  return own;
}

/// A header's labels end with those of its regions.
std::size_t first_region_label(const MeshHeader& header) {
  const std::size_t labels = header.face_labels.size();
  return labels - std::min(labels, region_names(header.face_regions).size());
}

FacePlace place_of(const TetMesh& mesh, std::uint64_t face) noexcept {
  const auto [a, b, c] = mesh.face(face);
  return {mesh.vertex(a), mesh.vertex(b), mesh.vertex(c)};
}

/// Labels a run of faces, which lie near each other.
void label_run(TetMesh& mesh, FaceLabeller& labeller, std::uint64_t begin, std::uint64_t end) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  WorldPoint min{kFar, kFar, kFar}, max{-kFar, -kFar, -kFar};
  for (std::uint64_t i = begin; i < end; ++i) {
    const WorldPoint p = middle_of(place_of(mesh, i));
    min = {std::min(min.x, p.x), std::min(min.y, p.y), std::min(min.z, p.z)};
    max = {std::max(max.x, p.x), std::max(max.y, p.y), std::max(max.z, p.z)};
  }
  labeller.focus({(min.x + max.x) / 2, (min.y + max.y) / 2, (min.z + max.z) / 2},
                 std::max({max.x - min.x, max.y - min.y, max.z - min.z}) / 2);
  for (std::uint64_t i = begin; i < end; ++i) {
    if (mesh.face_label(i) != 0) continue;
    const std::uint16_t label = labeller.label_of(place_of(mesh, i));
    std::memcpy(mesh.face_labels.bytes().data() + i * sizeof(label), &label, sizeof(label));
  }
}

}  // namespace

FaceLabeller::FaceLabeller(const MeshHeader& header, const Scene* scene)
    : regions_(header.face_regions) {
  if (regions_.empty()) return;
  const std::size_t first_label = first_region_label(header);
  const std::vector<std::string> names = region_names(regions_);
  for (const FaceRegion& region : regions_) {
    const auto place = std::ranges::find(names, region.name) - names.begin();
    Prepared prepared = prepare(region, scene);
    prepared.label = static_cast<std::uint16_t>(first_label + static_cast<std::size_t>(place));
    for (const WorldPoint& point : region.nearest) {
      points_.push_back({point, prepared_.size()});
    }
    if (scene != nullptr && !region.node.empty() && !scene_) scene_.emplace(*scene);
    prepared_.push_back(std::move(prepared));
  }
}

FaceLabeller::Prepared FaceLabeller::prepare(const FaceRegion& region,
                                             const Scene* scene) const {
  Prepared prepared;
  if (region.cylinder) {
    const Vector axis = vector_to(region.cylinder->end) - vector_to(region.cylinder->start);
    prepared.along = unit(axis);
    prepared.length = std::sqrt(dot(axis, axis));
  }
  if (region.half_space) prepared.normal = unit(vector_to(region.half_space->normal));
  if (region.facing) {
    prepared.direction = unit(vector_to(region.facing->direction));
    // A face at the very angle is meant, and rounding does not turn it away.
    constexpr double kRounding = 1e-12;
    prepared.least_cos = scene::cos_of_turns(region.facing->angle_deg / 360) - kRounding;
  }
  if (scene != nullptr && !region.node.empty()) {
    prepared.leaves = instructions_of(region.node, *scene);
  }
  return prepared;
}

void FaceLabeller::focus(const WorldPoint& centre, double half_edge) noexcept {
  if (scene_) scene_->focus(centre, half_edge);
}

std::uint16_t FaceLabeller::label_of(const FacePlace& face) noexcept {
  const WorldPoint middle = middle_of(face);
  for (std::size_t i = 0; i < regions_.size(); ++i) {
    if (has(i, middle, face)) return prepared_[i].label;
  }
  return 0;
}

bool FaceLabeller::has(std::size_t i,
                       const WorldPoint& middle,
                       const FacePlace& face) noexcept {
  const FaceRegion& region = regions_[i];
  const Prepared& prepared = prepared_[i];
  if (region.box && !is_in(*region.box, middle)) return false;
  if (region.ball && !is_in(*region.ball, middle)) return false;
  if (region.cylinder && !is_in(*region.cylinder, prepared.along, prepared.length, middle)) {
    return false;
  }
  if (region.half_space &&
      !(dot(prepared.normal, vector_to(middle)) <= region.half_space->offset)) {
    return false;
  }
  if (region.facing && !is_facing(prepared.direction, prepared.least_cos, face)) return false;
  if (!region.nearest.empty() && nearest_to(middle) != i) return false;
  return region.node.empty() || (scene_ && prepared.leaves[scene_->leaf_at(middle)]);
}

/// The region of the point that is nearest; of points that are equally near, the first one's.
std::size_t FaceLabeller::nearest_to(const WorldPoint& middle) const noexcept {
  double least = std::numeric_limits<double>::infinity();
  std::size_t region = regions_.size();
  for (const NearPoint& point : points_) {
    const double distance = distance_squared(vector_to(middle), vector_to(point.place));
    if (distance >= least) continue;
    least = distance;
    region = point.region;
  }
  return region;
}

void label_regions(TetMesh& mesh, const Scene* scene, const Cancellation& cancellation) {
  if (mesh.header.face_regions.empty()) return;
  constexpr std::uint64_t kFacesOfRun = 512, kRunsOfTask = 16;
  const std::uint64_t faces = mesh.header.face_count;
  for_each_range((faces + kFacesOfRun - 1) / kFacesOfRun, kRunsOfTask,
                 [&](std::size_t begin, std::size_t end) {
                   FaceLabeller labeller(mesh.header, scene);
                   labeller.stop_when(cancellation);
                   for (std::uint64_t run = begin; run < end && !cancellation.requested();
                        ++run) {
                     label_run(mesh, labeller, run * kFacesOfRun,
                               std::min(faces, (run + 1) * kFacesOfRun));
                   }
                 });
}

}  // namespace tet
