#include "core/fidelity/nearest_zero.h"

#include <cmath>

#include "core/base/tet_geometry.h"

namespace tet {
namespace {

double length(const Vector& v) noexcept { return std::sqrt(dot(v, v)); }

WorldPoint moved(const WorldPoint& p, const Vector& by) noexcept {
  return {p.x + by.x, p.y + by.y, p.z + by.z};
}

}  // namespace

/// Newton's method along the slope.
std::optional<WorldPoint> NearestZero::descend(WorldPoint from, int steps) noexcept {
  const double close = kClose * spacing_, reach = kReach * spacing_;
  for (int step = 0; step <= steps; ++step) {
    const PhiSlope here = phi_.slope_at(from);
    const double steepness = length(here.gradient);
    if (!(steepness > 0)) return std::nullopt;
    const double far = std::abs(here.phi) / steepness;
    if (far <= close) return from;
    const double scale = -std::min(far, reach) / (steepness * std::copysign(1, here.phi));
    from = moved(from,
                 {scale * here.gradient.x, scale * here.gradient.y, scale * here.gradient.z});
  }
  return std::nullopt;
}

std::optional<double> NearestZero::distance(const WorldPoint& p) noexcept {
  constexpr int kFirstSteps = 10, kLaterSteps = 3, kCorrections = 3;
  std::optional<WorldPoint> foot = descend(p, kFirstSteps);
  if (!foot) return std::nullopt;
  double best = length(from_to(*foot, p));
  if (best <= kClose * spacing_) return std::abs(phi_.at(p)) > 0 ? best : 0;
  for (int i = 0; i < kCorrections; ++i) {
    const Vector up = phi_.slope_at(*foot).gradient, way = from_to(*foot, p);
    const double along = dot(way, up) / dot(up, up);
    const Vector aside{way.x - along * up.x, way.y - along * up.y, way.z - along * up.z};
    if (!(length(aside) > kClose * spacing_)) break;
    foot = descend(moved(*foot, aside), kLaterSteps);
    if (!foot) break;
    const double far = length(from_to(*foot, p));
    if (far >= best) break;
    best = far;
  }
  return best;
}

}  // namespace tet
