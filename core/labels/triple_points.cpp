#include "core/labels/triple_points.h"

#include <algorithm>
#include <cmath>

#include "core/base/tet_geometry.h"
#include "core/labels/label_cost.h"
#include "core/stuffing/brick_geometry.h"
#include "core/stuffing/stuffed_lattice.h"

namespace tet {
namespace {

/// Shares of a face's second and third node.
struct Shares {
  double second, third;
  double least() const noexcept { return std::min({second, third, 1 - second - third}); }
};

Shares between(const Shares& a, const Shares& b, double part) noexcept {
  return {a.second + part * (b.second - a.second), a.third + part * (b.third - a.third)};
}

/// A point no farther off than a few faces, in the same direction from the face's middle: what
/// is farther off is not told from it by a nearest point.
Shares not_far(const FacePoint& point) noexcept {
  constexpr Shares kMiddle{1.0 / 3, 1.0 / 3};
  constexpr double kFar = 4;
  const Shares at{double{point.second}, double{point.third}};
  const double off =
      std::max(std::abs(at.second - kMiddle.second), std::abs(at.third - kMiddle.third));
  return off > kFar ? between(kMiddle, at, kFar / off) : at;
}

FacePoint rounded(const Shares& shares) noexcept {
  return {static_cast<float>(shares.second), static_cast<float>(shares.third)};
}

class TriplePlacing {
 public:
  explicit TriplePlacing(const FaceAround& face) noexcept : face_(face) {
    for (std::size_t i = 0; i < 3; ++i) {
      node_[i] = {0.5 * face.node[i].x, 0.5 * face.node[i].y, 0.5 * face.node[i].z};
    }
    for (std::size_t e = 0; e < 3; ++e) {
      const WorldPoint &low = node_[kFaceEdge[e][0]], &high = node_[kFaceEdge[e][1]];
      const double t = double{face.fraction[e]};
      cut_[e] = {low.x + t * (high.x - low.x), low.y + t * (high.y - low.y),
                 low.z + t * (high.z - low.z)};
    }
  }

  /// The mean of the cut points.
  Shares mean() const noexcept {
    const auto [t01, t12, t02] = face_.fraction;
    return {(double{t01} + (1 - double{t12})) / 3, (double{t12} + double{t02}) / 3};
  }

  /// The nearest point whose shares are large enough.
  Shares well_within(const Shares& wished) const noexcept {
    if (wished.least() >= kLeastShare) return wished;
    constexpr double kMost = 1 - 2 * kLeastShare;
    constexpr std::array<Shares, 3> kTips{
        {{kLeastShare, kLeastShare}, {kMost, kLeastShare}, {kLeastShare, kMost}}};
    const WorldPoint goal = place(wished);
    Shares nearest = kTips[0];
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < 3; ++i) {
      const Shares &from = kTips[i], &to = kTips[(i + 1) % 3];
      const Vector side = from_to(place(from), place(to));
      const double part =
          std::clamp(dot(from_to(place(from), goal), side) / dot(side, side), 0.0, 1.0);
      const Shares at = between(from, to, part);
      const Vector off = from_to(place(at), goal);
      if (dot(off, off) >= least) continue;
      least = dot(off, off);
      nearest = at;
    }
    return nearest;
  }

  /// All tets that join the six triangles around a point to an apex are good.
  bool is_good(const FacePoint& point) const noexcept {
    const WorldPoint at = place_on_face(face_.node, point);
    const std::array<const WorldPoint*, 6> ring{&node_[0], &cut_[0],  &node_[1],
                                                &cut_[1],  &node_[2], &cut_[2]};
    const Vector normal = cross(from_to(node_[0], node_[1]), from_to(node_[0], node_[2]));
    for (const WorldPoint& apex : face_.apex) {
      const bool above = dot(normal, from_to(node_[0], apex)) > 0;
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const WorldPoint &p = *ring[i], &q = *ring[(i + 1) % ring.size()];
        const double cost = above ? tet_cost(at, p, q, apex) : tet_cost(at, q, p, apex);
        if (!(cost <= kGoodCost)) return false;
      }
    }
    return true;
  }

 private:
  WorldPoint place(const Shares& shares) const noexcept {
    const Vector u = from_to(node_[0], node_[1]), v = from_to(node_[0], node_[2]);
    return {node_[0].x + (shares.second * u.x + shares.third * v.x),
            node_[0].y + (shares.second * u.y + shares.third * v.y),
            node_[0].z + (shares.second * u.z + shares.third * v.z)};
  }

  const FaceAround& face_;
  std::array<WorldPoint, 3> node_, cut_;
};

/// Lowest nodes of a brick's own faces and of those of its own tets, by family.
const std::array<HaloSet, kFaceFamilies>& faces_in_reach() {
  static const std::array<HaloSet, kFaceFamilies> faces = [] {
    std::array<HaloSet, kFaceFamilies> all;
    all.fill(kOwnNodes);
    for (std::size_t number = 0; number < kTetShapes; ++number) {
      for (std::size_t i = 0; i < kTetFaces; ++i) {
        const int low = kTetShape[number].offset[nodes_of_face(i)[0]];
        all[kFaceOfShape[number][i]] |= seen_from(kOwnCells, -low);
      }
    }
    return all;
  }();
  return faces;
}

WorldPoint place_of_joker(NodeKind kind,
                          int node,
                          const LabelSamples& samples,
                          const WarpedLabels& warped) noexcept {
  const auto [family, low] =
      moved_along(kind, node, warped.direction[kind][static_cast<std::size_t>(node)]);
  return place_on_edge(
      node_coord(family_kind(family), low), family_direction(family),
      samples.fraction[static_cast<std::size_t>(family)][static_cast<std::size_t>(low)]);
}

FaceAround face_around(const TripleFace& of,
                       const LabelSamples& samples,
                       const WarpedLabels& warped) noexcept {
  const FaceFamily& family = kFaceFamily[of.family];
  FaceAround face;
  const LatticeCoord low = node_coord(family.kind[0], of.low);
  for (std::size_t i = 0; i < 3; ++i) face.node[i] = low + family.step[i];
  for (std::size_t e = 0; e < 3; ++e) {
    const int from = of.low + family.to_node[kFaceEdge[e][0]];
    face.fraction[e] = samples.fraction[family.edge_family[e]][static_cast<std::size_t>(from)];
  }
  for (std::size_t side = 0; side < 2; ++side) {
    const OppositeNode& beyond = family.opposite[side];
    const int node = of.low + beyond.to_node;
    if (warped.joker[beyond.kind].test(node)) {
      face.apex[side] = place_of_joker(beyond.kind, node, samples, warped);
      continue;
    }
    const LatticeCoord sum = face.node[0] + face.node[1] + face.node[2] + (low + beyond.step);
    face.apex[side] = {0.125 * sum.x, 0.125 * sum.y, 0.125 * sum.z};
  }
  return face;
}

}  // namespace

FacePoint put_triple_point(const FaceAround& face, const FacePoint& wished) noexcept {
  const TriplePlacing placing(face);
  const Shares mean = placing.mean();
  if (!std::isfinite(wished.second) || !std::isfinite(wished.third)) return rounded(mean);
  const Shares goal = placing.well_within(not_far(wished));
  for (const double part : {1.0, 0.75, 0.5, 0.25}) {
    const FacePoint point = rounded(between(mean, goal, part));
    if (placing.is_good(point)) return point;
  }
  return rounded(mean);
}

void TriplePoints::find(LabelSampler& sampler,
                        BrickCoord brick,
                        const LabelSamples& samples,
                        const WarpedLabels& warped) {
  list_.clear();
  for (std::size_t f = 0; f < kFaceFamilies; ++f) {
    const FaceFamily& family = kFaceFamily[f];
    HaloSet& found = faces_[f];
    found = faces_in_reach()[f];
    for (std::size_t e = 0; e < 3; ++e) {
      found &= seen_from(warped.cut[family.edge_family[e]], family.to_node[kFaceEdge[e][0]]);
    }
    for_each_bit(found, [&](int low) {
      list_.push_back({static_cast<std::uint8_t>(f), static_cast<std::uint16_t>(low)});
    });
  }
  if (list_.empty()) return;
  wished_.resize(list_.size());
  sampler.sample_triples(brick, list_, samples, wished_);
  for (std::size_t i = 0; i < list_.size(); ++i) {
    point_[list_[i].family][slot_of(list_[i].low)] =
        put_triple_point(face_around(list_[i], samples, warped), wished_[i]);
  }
}

}  // namespace tet
