// Volumes and angles of tets, written as plainly as they read.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace tet::test {

using ReferencePlace = std::array<double, 3>;

inline ReferencePlace minus(const ReferencePlace& a, const ReferencePlace& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline ReferencePlace times(const ReferencePlace& a, const ReferencePlace& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double dot_of(const ReferencePlace& a, const ReferencePlace& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline ReferencePlace mean(const std::vector<ReferencePlace>& places) {
  ReferencePlace sum{};
  for (const ReferencePlace& p : places) {
    for (std::size_t i = 0; i < 3; ++i) sum[i] += p[i];
  }
  for (double& v : sum) v /= static_cast<double>(places.size());
  return sum;
}

/// Six times the volume, signed.
inline double six_volumes(const std::array<ReferencePlace, 4>& p) {
  return dot_of(minus(p[1], p[0]), times(minus(p[2], p[0]), minus(p[3], p[0])));
}

/// The angle at the edge of a and b, degrees.
inline double angle_at(const ReferencePlace& a,
                       const ReferencePlace& b,
                       const ReferencePlace& c,
                       const ReferencePlace& d) {
  const ReferencePlace along = minus(b, a);
  const auto across = [&](const ReferencePlace& p) {
    const ReferencePlace to = minus(p, a);
    const double t = dot_of(to, along) / dot_of(along, along);
    return ReferencePlace{to[0] - t * along[0], to[1] - t * along[1], to[2] - t * along[2]};
  };
  const ReferencePlace u = across(c), v = across(d);
  const double cosine = dot_of(u, v) / std::sqrt(dot_of(u, u) * dot_of(v, v));
  return std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi;
}

/// A triangle's least height.
inline double width_of(const ReferencePlace& a,
                       const ReferencePlace& b,
                       const ReferencePlace& c) {
  const ReferencePlace ab = minus(b, a), ac = minus(c, a), bc = minus(c, b);
  const ReferencePlace area = times(ab, ac);
  const double longest = std::max({dot_of(ab, ab), dot_of(ac, ac), dot_of(bc, bc)});
  return std::sqrt(dot_of(area, area) / longest);
}

struct ReferenceAngles {
  double least = 180, greatest = 0, width = 1;
  void add(const std::array<ReferencePlace, 4>& p) {
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = i + 1; j < 4; ++j) {
        std::array<std::size_t, 2> others{};
        std::size_t next = 0;
        for (std::size_t k = 0; k < 4; ++k) {
          if (k != i && k != j) others[next++] = k;
        }
        const double angle = angle_at(p[i], p[j], p[others[0]], p[others[1]]);
        least = std::min(least, angle);
        greatest = std::max(greatest, angle);
        width = std::min(width, width_of(p[others[0]], p[others[1]], p[i]));
        width = std::min(width, width_of(p[others[0]], p[others[1]], p[j]));
      }
    }
  }
  bool good() const { return least >= 12 && greatest <= 148.5 && width >= 0.04; }
};

}  // namespace tet::test
