#include "tests/certificate/dihedral.h"

#include <algorithm>
#include <limits>

#include "core/lattice/bcc.h"

namespace tet::certificate {
namespace {

bool is_still(const Place& along) { return (along[0] | along[1] | along[2]) == 0; }

/// What leads from one corner to another: a parameter that moves both counts once.
class Way {
 public:
  Way(const Corner& from, const Corner& to) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      base_[axis] = to.base[axis] - from.base[axis];
    }
    for (std::size_t k = 0; k < kParameters; ++k) {
      const Place &there = to.along[k], &here = from.along[k];
      const Place along{there[0] - here[0], there[1] - here[1], there[2] - here[2]};
      if (!is_still(along)) moving_[count_++] = {along, k};
    }
  }

  IntervalVector over(const Box& box, double blur) const {
    IntervalVector way{Interval(base_[0]), Interval(base_[1]), Interval(base_[2])};
    for (std::size_t i = 0; i < count_; ++i) {
      const auto& [along, k] = moving_[i];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (along[axis] != 0) way[axis] += static_cast<double>(along[axis]) * box[k];
      }
    }
    if (blur == 0) return way;
    for (Interval& coordinate : way) {
      coordinate += Interval(-blur, blur) - Interval(-blur, blur);
    }
    return way;
  }

 private:
  struct Moving {
    Place along;
    std::size_t parameter;
  };
  Place base_;
  std::array<Moving, kParameters> moving_;
  std::size_t count_ = 0;
};

/// The corners at an angle: its edge from a to b, then c and d, so that the tet a, b, c, d is
/// an even permutation of the given one.
constexpr std::array<std::array<std::uint8_t, 4>, kAngles> kAngleCorners = [] {
  std::array<std::array<std::uint8_t, 4>, kAngles> corners{};
  for (std::size_t e = 0; e < kAngles; ++e) {
    const auto [a, b] = kTetEdge[e];
    const auto [c, d] = kTetEdge[kAngles - 1 - e];  // the opposite edge
    const bool odd = e == 1 || e == 4;              // 0 2 1 3 and 1 3 0 2
    corners[e] = {a, b, odd ? d : c, odd ? c : d};
  }
  return corners;
}();

/// An angle's edge e from a to b, what leads to c and d from a, and the normals of its faces.
struct Hinge {
  IntervalVector e, p, q, u, v;
  Interval six_volumes;

  Hinge(const Tet& tet, std::size_t angle, const Box& box, double blur) {
    const auto [a, b, c, d] = kAngleCorners[angle];
    e = Way(tet[a], tet[b]).over(box, blur);
    p = Way(tet[a], tet[c]).over(box, blur);
    q = Way(tet[a], tet[d]).over(box, blur);
    u = cross(e, p);
    v = cross(e, q);
    six_volumes = dot(u, q);
  }
};

Interval dot(const IntervalVector& u, const Place& v) {
  return u[0] * Interval(v[0]) + u[1] * Interval(v[1]) + u[2] * Interval(v[2]);
}

IntervalVector scaled(const IntervalVector& u, const Interval& by) {
  return {u[0] * by, u[1] * by, u[2] * by};
}

Interval length(const IntervalVector& u) { return sqrt(squared_length(u)); }

bool are_parallel(const Place& u, const Place& v) {
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    if (u[i] * v[j] != u[j] * v[i]) return false;
  }
  return true;
}

/// Whether all that a parameter moves goes along one line. Then a volume has no square of it.
bool moves_on_a_line(const Tet& tet, std::size_t k) {
  const Place* line = nullptr;
  for (const Corner& corner : tet) {
    if (is_still(corner.along[k])) continue;
    if (line != nullptr && !are_parallel(*line, corner.along[k])) return false;
    line = &corner.along[k];
  }
  return true;
}

/// Six volumes over a box, from its vertices: exact but for the blur and for rounding, as each
/// parameter's part is linear. Nothing is known of other tets.
Interval volume_from_vertices(const Tet& tet, const Box& box, double blur) {
  std::array<std::size_t, kParameters> open{};
  std::size_t count = 0;
  for (std::size_t k = 0; k < kParameters; ++k) {
    if (!moves_on_a_line(tet, k)) return {-kInfinity, kInfinity};
    if (box[k].lower() < box[k].upper()) open[count++] = k;
  }
  const auto [a, b, c, d] = kAngleCorners[0];
  const Way e(tet[a], tet[b]), p(tet[a], tet[c]), q(tet[a], tet[d]);
  Interval hull;
  for (std::size_t vertex = 0; vertex < std::size_t{1} << count; ++vertex) {
    Box at = box;
    for (std::size_t i = 0; i < count; ++i) {
      const Interval& range = box[open[i]];
      at[open[i]] = Interval((vertex >> i & 1) != 0 ? range.upper() : range.lower());
    }
    // Six volumes as Hinge has them for the first angle.
    const Interval here =
        certificate::dot(cross(e.over(at, blur), p.over(at, blur)), q.over(at, blur));
    hull = vertex == 0 ? here : boost::numeric::hull(hull, here);
  }
  return hull;
}

/// An angle, its volume made sharp where the quick enclosure of that leaves much open.
Hinge sharp_hinge(const Tet& tet, std::size_t angle, const Box& box, double blur) {
  constexpr double kMuch = 2;
  Hinge hinge(tet, angle, box, blur);
  if (hinge.six_volumes.upper() > kMuch * hinge.six_volumes.lower()) {
    const Interval sharp = volume_from_vertices(tet, box, blur);
    hinge.six_volumes = {std::max(hinge.six_volumes.lower(), sharp.lower()),
                         std::min(hinge.six_volumes.upper(), sharp.upper())};
  }
  return hinge;
}

const Interval kAnything(-kInfinity, kInfinity);

/// The sum of the lengths of an angle's four gradients. A corner c that moves by x turns the
/// normal u of its face by |e| (x . u) / |u|^2; the ends of the edge count by their shares of
/// the feet of c and d on it.
Interval sensitivity_of(const Hinge& hinge) {
  const Interval uu = squared_length(hinge.u), vv = squared_length(hinge.v);
  const Interval ee = squared_length(hinge.e);
  if (!(uu.lower() > 0 && vv.lower() > 0 && ee.lower() > 0)) return {0, kInfinity};
  const Interval edge = sqrt(ee);
  const Interval lambda = certificate::dot(hinge.p, hinge.e) / ee,
                 mu = certificate::dot(hinge.q, hinge.e) / ee;
  const IntervalVector by_c = scaled(hinge.u, edge / uu), by_d = scaled(hinge.v, edge / vv);
  return edge / sqrt(uu) + edge / sqrt(vv) +
         length(scaled(by_d, Interval(1) - mu) - scaled(by_c, Interval(1) - lambda)) +
         length(scaled(by_d, mu) - scaled(by_c, lambda));
}

}  // namespace

// The angle theta turns u into v about e: u x v = e (e . p x q), so with the volume's sign it
// is the one inside the tet, and cot(theta) = (u . v) / (|e| six_volumes).
//
// A corner c that moves by x turns the face's normal u by |e| (x . u) / |u|^2. The ends of the
// edge count by their shares of the foot of c on it: 1 - lambda and lambda, lambda = p . e /
// e^2.
Dihedral enclose_dihedral(const Tet& tet, std::size_t angle, const Box& box, double blur) {
  const Hinge hinge = sharp_hinge(tet, angle, box, blur);
  Dihedral out;
  if (!(hinge.six_volumes.lower() > 0)) return out;
  const Interval uu = squared_length(hinge.u), vv = squared_length(hinge.v);
  const Interval ee = squared_length(hinge.e);
  if (!(uu.lower() > 0 && vv.lower() > 0 && ee.lower() > 0)) return out;
  out.positive = true;
  const Interval edge = sqrt(ee);
  const Interval per_sine = Interval(1) / (edge * hinge.six_volumes);
  out.cotangent = dot(hinge.u, hinge.v) * per_sine;

  const Interval lambda = dot(hinge.p, hinge.e) / ee, mu = dot(hinge.q, hinge.e) / ee;
  const Interval rest_lambda = Interval(1) - lambda, rest_mu = Interval(1) - mu;
  // d cot = -(1 + cot^2) d theta, and 1 + cot^2 = |u|^2 |v|^2 / (|e| six_volumes)^2.
  const Interval by_u = vv * per_sine / hinge.six_volumes;
  const Interval by_v = uu * per_sine / hinge.six_volumes;
  const auto [a, b, c, d] = kAngleCorners[angle];
  for (std::size_t k = 0; k < kParameters; ++k) {
    Interval slope(0);
    const auto add = [&](const Place& along, const Interval& share_u, const Interval& share_v) {
      if (is_still(along)) return;
      slope += share_u * by_u * dot(hinge.u, along) - share_v * by_v * dot(hinge.v, along);
    };
    add(tet[a].along[k], -rest_lambda, -rest_mu);
    add(tet[b].along[k], -lambda, -mu);
    add(tet[c].along[k], Interval(1), Interval(0));
    add(tet[d].along[k], Interval(0), Interval(1));
    out.slope[k] = slope;
  }
  if (blur != 0) out.sensitivity = sensitivity_of(hinge);
  return out;
}

Interval enclose_sensitivity(const Tet& tet, std::size_t angle, const Box& box, double blur) {
  return sensitivity_of(Hinge(tet, angle, box, blur));
}

Interval enclose_positive_sensitivity(const Tet& tet,
                                      std::size_t angle,
                                      const Box& box,
                                      double blur) {
  const Hinge hinge = sharp_hinge(tet, angle, box, blur);
  if (!(hinge.six_volumes.lower() > 0)) return {0, kInfinity};
  return sensitivity_of(hinge);
}

Interval enclose_cotangent(const Tet& tet, std::size_t angle, const Box& box) {
  const Hinge hinge(tet, angle, box, 0);
  if (!(hinge.six_volumes.lower() > 0)) return kAnything;
  return dot(hinge.u, hinge.v) / (sqrt(squared_length(hinge.e)) * hinge.six_volumes);
}

}  // namespace tet::certificate
