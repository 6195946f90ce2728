#include "core/mesh/vertex_mover.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/mix_bits.h"
#include "core/mesh/faces.h"

namespace tet {
namespace {

// Steps in leaves. Bunny, torus and gyroid end within a tenth of a degree of the same angles
// with a first step of 0.08 to 0.3 and a last one of 0.005; half a degree lower with one of
// 0.05.
constexpr double kFirstStep = 0.15, kLastStep = 0.02;
/// Over which a cost is differentiated, in leaves.
constexpr double kDifference = 1e-3;
/// A cost must fall by this, about a hundredth of a degree: what is worth a move.
constexpr double kLeastGain = 1e-4;
/// Hides that a star adds an angle up in another order than whoever measures the mesh.
constexpr double kRounding = 1e-9;

/// Towards the faces and corners of a cube, so that any direction is near one of them.
std::array<Vector, 14> ways_to_go() {
  const double s = 1 / std::sqrt(3.0);
  return {{{1, 0, 0},
           {0, 1, 0},
           {0, 0, 1},
           {-1, 0, 0},
           {0, -1, 0},
           {0, 0, -1},
           {s, s, s},
           {s, s, -s},
           {s, -s, s},
           {s, -s, -s},
           {-s, s, s},
           {-s, s, -s},
           {-s, -s, s},
           {-s, -s, -s}}};
}

const std::array<Vector, 14> kWays = ways_to_go();

double length(const Vector& v) noexcept { return std::sqrt(dot(v, v)); }

/// What the faces around a vertex say, by XOR of their hashes as seen from each tet: those
/// seen twice cancel, so zero means that all are, but for an accident once in 2^64.
struct FacesAround {
  std::uint64_t all = 0;
  std::uint64_t outside = 0;  ///< of the outside region's tets alone

  bool on_boundary() const noexcept { return all != 0; }
  bool between_regions() const noexcept { return outside != 0; }
};

FacesAround faces_around(const TetMesh& mesh, std::span<const TetCorner> star) noexcept {
  FacesAround faces;
  for (const TetCorner corner : star) {
    const Triangle link = face_of(mesh.tet(corner.tet()), corner.corner());
    const std::uint64_t a = mix_bits(link[0]), b = mix_bits(link[1]), c = mix_bits(link[2]);
    const std::uint64_t hash = mix_bits(a + b) ^ mix_bits(b + c) ^ mix_bits(c + a);
    faces.all ^= hash;
    if (mesh.region(corner.tet()) == MeshRegion::kOutside) faces.outside ^= hash;
  }
  return faces;
}

}  // namespace

VertexMover::VertexMover(const TetMesh& mesh,
                         const PhiField& field,
                         const LatticeToWorld& to_world,
                         const AngleGoal& goal,
                         const AngleRange& mesh_angles)
    : mesh_(mesh),
      goal_(goal),
      limit_{std::min(goal.good.largest_cosine, mesh_angles.largest_cosine),
             std::max(goal.good.smallest_cosine, mesh_angles.smallest_cosine)},
      projector_(field, to_world, mesh.header),
      star_(goal) {}

VertexMover::Freedom VertexMover::freedom_of(std::span<const TetCorner> star,
                                             const WorldPoint& place) noexcept {
  const FacesAround faces = faces_around(mesh_, star);
  // Where both sides are meshed the surface runs between them, and the boundary is a box.
  const bool on_box = mesh_.header.has_regions && faces.on_boundary();
  if (on_box) return Freedom::kNowhere;
  if (!faces.on_boundary() && !faces.between_regions()) return Freedom::kAnywhere;
  const PhiSlope here = projector_.at(place);
  slope_ = here.gradient;
  return projector_.is_on_surface(here) ? Freedom::kSurface : Freedom::kNowhere;
}

VertexMover::Outcome VertexMover::move(std::uint64_t vertex,
                                       std::span<const TetCorner> star,
                                       const WorldPoint& home,
                                       double leaf) noexcept {
  const WorldPoint start = mesh_.stored_position(vertex);
  star_.gather(mesh_, star);
  const AngleRange before = star_.angles(start);
  if (goal_.met_by(before)) return {{}, true};
  freedom_ = freedom_of(star, start);
  if (freedom_ == Freedom::kNowhere) return {};

  home_ = home;
  leaf_ = leaf * mesh_.header.spacing;
  place_ = start;
  bound_.range = {std::max(before.largest_cosine, limit_.largest_cosine) - kRounding,
                  std::min(before.smallest_cosine, limit_.smallest_cosine) + kRounding};
  bound_.cost = goal_.cost(before) - kLeastGain;
  double step = kFirstStep;
  while (bound_.cost > goal_.good_cost() && step >= kLastStep) {
    if (!go_downhill(step) && !go_anywhere(step)) step /= 2;
  }
  if (place_ == start) return {};
  return {place_, bound_.cost <= goal_.good_cost()};
}

/// Down the slope of the worst tet, as far as it leads.
bool VertexMover::go_downhill(double step) noexcept {
  star_.angles(place_);
  const Vector way = along_surface(star_.descent(place_, kDifference * leaf_));
  bool gone = false;
  while (go(way, step)) gone = true;
  return gone;
}

bool VertexMover::go_anywhere(double step) noexcept {
  return std::any_of(kWays.begin(), kWays.end(),
                     [&](const Vector& way) { return go(along_surface(way), step); });
}

bool VertexMover::go(const Vector& way, double step) noexcept {
  const double far = length(way);
  if (!(far > 0) || bound_.cost <= goal_.good_cost()) return false;
  const double scale = step * leaf_ / far;
  const WorldPoint ahead{place_.x + scale * way.x, place_.y + scale * way.y,
                         place_.z + scale * way.z};
  const std::optional<WorldPoint> place = freedom_ == Freedom::kSurface
                                              ? projector_.project(ahead, slope_)
                                              : projector_.rounded(ahead);
  if (!place || length(from_to(home_, *place)) > kReach * leaf_) return false;
  const std::optional<double> cost = star_.cost_below(bound_, *place);
  if (!cost) return false;
  bound_.cost = *cost - kLeastGain;
  place_ = *place;
  return true;
}

Vector VertexMover::along_surface(const Vector& way) const noexcept {
  if (freedom_ != Freedom::kSurface) return way;
  const double upwards = dot(way, slope_) / dot(slope_, slope_);
  return {way.x - upwards * slope_.x, way.y - upwards * slope_.y, way.z - upwards * slope_.z};
}

}  // namespace tet
