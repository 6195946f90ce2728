#include "core/mesh/improve/star.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/mesh/faces.h"

namespace tet {

/// The worst there are when the tet is not positive.
AngleRange Star::Face::angles(const WorldPoint& middle) const noexcept {
  const Vector u = from_to(middle, b), v = from_to(middle, c), w = from_to(middle, d);
  const Vector nb = cross(v, w), nc = cross(w, u), nd = cross(u, v);
  if (!(dot(u, nb) > 0)) return {1, -1};
  const double rb = 1 / dot(nb, nb), rc = 1 / dot(nc, nc), rd = 1 / dot(nd, nd);
  const auto cosine = [](const Vector& m, const Vector& n, double per_m, double per_n) {
    const double inward = -dot(m, n);
    return (inward * per_m) * (std::abs(inward) * per_n);
  };
  AngleRange range;
  range.add(cosine(normal, nb, per_square, rb));
  range.add(cosine(normal, nc, per_square, rc));
  range.add(cosine(normal, nd, per_square, rd));
  range.add(cosine(nb, nc, rb, rc));
  range.add(cosine(nb, nd, rb, rd));
  range.add(cosine(nc, nd, rc, rd));
  return range;
}

void Star::gather(const TetMesh& mesh, std::span<const TetCorner> corners) {
  faces_.clear();
  for (const TetCorner corner : corners) {
    const Triangle opposite = face_of(mesh.tet(corner.tet()), corner.corner());
    const WorldPoint b = mesh.stored_position(opposite[0]);
    const WorldPoint c = mesh.stored_position(opposite[1]);
    const WorldPoint d = mesh.stored_position(opposite[2]);
    const Vector normal = cross(from_to(b, d), from_to(b, c));
    faces_.push_back({b, c, d, normal, 1 / dot(normal, normal)});
  }
}

AngleRange Star::angles(const WorldPoint& middle) noexcept {
  AngleRange all;
  double worst = -1;
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    const AngleRange angles = faces_[i].angles(middle);
    all.add(angles);
    const double cost = goal_.cost(angles);
    if (cost <= worst) continue;
    worst = cost;
    std::swap(faces_[0], faces_[i]);
  }
  return all;
}

std::optional<double> Star::cost_below(const StarBound& bound,
                                       const WorldPoint& middle) noexcept {
  double worst = -1;
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    const AngleRange angles = faces_[i].angles(middle);
    const double cost = goal_.cost(angles);
    const bool below = cost < bound.cost &&
                       angles.largest_cosine < bound.range.largest_cosine &&
                       angles.smallest_cosine > bound.range.smallest_cosine;
    if (!below) {
      // What refused one place is likely to refuse the next one too.
      std::swap(faces_[i / 2], faces_[i]);
      return std::nullopt;
    }
    worst = std::max(worst, cost);
  }
  return worst;
}

Vector Star::descent(const WorldPoint& middle, double step) const noexcept {
  const auto cost_at = [&](double x, double y, double z) {
    return goal_.cost(faces_[0].angles({middle.x + x, middle.y + y, middle.z + z}));
  };
  const double here = cost_at(0, 0, 0);
  return {here - cost_at(step, 0, 0), here - cost_at(0, step, 0), here - cost_at(0, 0, step)};
}

}  // namespace tet
