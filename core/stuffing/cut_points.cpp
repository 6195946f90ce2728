#include "core/stuffing/cut_points.h"

#include <cstddef>
#include <emmintrin.h>

namespace tet {
namespace {

/// Bits of the 16 values of a row for which value < 0 (low half) and value > 0 (high half).
struct RowSigns {
  std::uint64_t below, above;
};

RowSigns row_signs(const float* row) noexcept {
  RowSigns signs{0, 0};
  const __m128 zero = _mm_setzero_ps();
  for (int i = 0; i < 4; ++i) {
    const __m128 phi = _mm_load_ps(row + 4 * i);
    signs.below |= static_cast<std::uint64_t>(_mm_movemask_ps(_mm_cmplt_ps(phi, zero)))
                   << 4 * i;
    signs.above |= static_cast<std::uint64_t>(_mm_movemask_ps(_mm_cmpgt_ps(phi, zero)))
                   << 4 * i;
  }
  return signs;
}

/// Where samples are valid; see BrickSamples.
constexpr std::array<HaloSet, kNodeKinds> kSampled{halo_cube(-2, 10), halo_cube(-2, 9)};

/// Edges of a family with an end among the nodes that a brick needs to know.
constexpr HaloSet edges_in_reach(int family) noexcept {
  const NodeKind kind = family_kind(family);
  const int offset = end_offset(kind, family_direction(family));
  const HaloSet nodes = halo_cube(kNodeMin, kNodeMax);
  return nodes | seen_from(nodes, offset);
}
constexpr std::array<HaloSet, kEdgeFamilies> kEdgesInReach = [] {
  std::array<HaloSet, kEdgeFamilies> edges;
  for (int f = 0; f < kEdgeFamilies; ++f) {
    edges[static_cast<std::size_t>(f)] = edges_in_reach(f);
  }
  return edges;
}();

/// Zero of the line through (0, a) and (1, b), signs strictly opposite; in [0, 1].
float linear_zero(float a, float b) noexcept { return a / (a - b); }

/// Zero of `phi` on [0, 1], where it is `a` at 0 and `b` at 1: secant steps that keep a
/// bracket.
template <class Phi>
float bracketed_zero(float a, float b, const Phi& phi) noexcept {
  constexpr int kSteps = 2;
  float low = 0, high = 1;
  float t = linear_zero(a, b);
  for (int step = 0; step < kSteps; ++step) {
    const float value = phi(t);
    if ((value < 0) == (a < 0) && value != 0) {
      low = t;
      a = value;
    } else {
      high = t;
      b = value;
    }
    t = low + (high - low) * linear_zero(a, b);
  }
  return t;
}

/// An edge of the lattice, by its lower node.
struct Edge {
  NodeKind kind;
  int low;  // halo index
  int direction;
};

/// Zero on the edge between two centres: the trilinear field is linear on either side of the
/// face.
float zero_through_face(
    const BrickSamples& samples, int low, int axis, float a, float b) noexcept {
  constexpr std::array<std::array<int, 2>, 3> kAcross{
      {
       {offset_index(0, 1, 0), offset_index(0, 0, 1)},
       {offset_index(1, 0, 0), offset_index(0, 0, 1)},
       {offset_index(1, 0, 0), offset_index(0, 1, 0)},
       }
  };
  constexpr std::array<int, 3> kAlong{offset_index(1, 0, 0), offset_index(0, 1, 0),
                                      offset_index(0, 0, 1)};
  const auto ax = static_cast<std::size_t>(axis);
  const float* face = &samples.corner[static_cast<std::size_t>(low + kAlong[ax])];
  const float middle = 0.25F * ((face[0] + face[kAcross[ax][0]]) +
                                (face[kAcross[ax][1]] + face[kAcross[ax][0] + kAcross[ax][1]]));
  if (middle == 0) return 0.5F;
  if ((middle < 0) == (a < 0)) return 0.5F + 0.5F * linear_zero(middle, b);
  return 0.5F * linear_zero(a, middle);
}

/// Zero on a short edge: the trilinear field is a cubic along the cell's diagonal.
float zero_on_diagonal(const BrickSamples& samples,
                       const Edge& edge,
                       float a,
                       float b) noexcept {
  const auto [low_kind, low, direction] = edge;
  const int centre = low_kind == kCentre ? low : low + end_offset(kCorner, direction);
  const int corner = low_kind == kCorner ? low : low + end_offset(kCentre, direction);
  // The corner as a vertex of its cell, each coordinate 0 or 1; steps lead away from it.
  const int cell_corner = corner - centre;
  const int sx = cell_corner & 256 ? -256 : 256;
  const int sy = cell_corner & 16 ? -16 : 16;
  const int sz = cell_corner & 1 ? -1 : 1;
  const float* phi = &samples.corner[static_cast<std::size_t>(corner)];
  const float near_sum = phi[sx] + phi[sy] + phi[sz];
  const float far_sum = phi[sx + sy] + phi[sx + sz] + phi[sy + sz];
  const float here = phi[0], far = phi[sx + sy + sz];
  const bool from_corner = low_kind == kCorner;
  return bracketed_zero(a, b, [&](float t) {
    const float s = 0.5F * (from_corner ? t : 1 - t);
    const float r = 1 - s;
    return r * r * (r * here + s * near_sum) + s * s * (r * far_sum + s * far);
  });
}

/// Zero on any edge of a lattice that does not sit on the voxels: phi is asked for.
float zero_of_field(
    PhiSampler& sampler, BrickCoord brick, const Edge& edge, float a, float b) noexcept {
  const LatticeCoord from = node_coord(edge.kind, edge.low);
  const LatticeCoord along = kDirection[static_cast<std::size_t>(edge.direction)];
  return bracketed_zero(a, b, [&](float t) {
    const double s = static_cast<double>(t);
    return sampler.at(8.0 * brick.x + 0.5 * (from.x + s * along.x),
                      8.0 * brick.y + 0.5 * (from.y + s * along.y),
                      8.0 * brick.z + 0.5 * (from.z + s * along.z));
  });
}

void find_fractions(const BrickSamples& samples,
                    PhiSampler& sampler,
                    BrickCoord brick,
                    int family,
                    CutPoints& cuts) noexcept {
  const NodeKind kind = family_kind(family);
  const int direction = family_direction(family);
  const int offset = end_offset(kind, direction);
  const auto& low_phi = kind == kCorner ? samples.corner : samples.centre;
  const auto& high_phi = end_kind(kind, direction) == kCorner ? samples.corner : samples.centre;
  auto& fraction = cuts.fraction[static_cast<std::size_t>(family)];
  const bool at_voxels = sampler.field().at_voxels();
  for_each_bit(cuts.cut[static_cast<std::size_t>(family)], [&](int low) {
    const auto i = static_cast<std::size_t>(low);
    const float a = low_phi[i];
    const float b = high_phi[static_cast<std::size_t>(low + offset)];
    if (!at_voxels) {
      fraction[i] = zero_of_field(sampler, brick, {kind, low, direction}, a, b);
    } else if (!is_long(direction)) {
      fraction[i] = zero_on_diagonal(samples, {kind, low, direction}, a, b);
    } else if (kind == kCentre) {
      fraction[i] = zero_through_face(samples, low, direction, a, b);
    } else {
      fraction[i] = linear_zero(a, b);  // trilinear is linear along a voxel edge
    }
  });
}

}  // namespace

void find_signs(const BrickSamples& samples, NodeSigns& signs) noexcept {
  for (const NodeKind kind : {kCorner, kCentre}) {
    const auto& phi = kind == kCorner ? samples.corner : samples.centre;
    HaloSet inside, outside;
    for (std::size_t row = 0; row < kHaloNodes / 16; ++row) {
      const RowSigns bits = row_signs(&phi[row * 16]);
      inside.word[row / 4] |= bits.below << (row % 4 * 16);
      outside.word[row / 4] |= bits.above << (row % 4 * 16);
    }
    signs.inside[kind] = inside & kSampled[kind];
    signs.outside[kind] = outside & kSampled[kind];
  }
}

bool NodeSigns::one_sided() const noexcept {
  const auto every_sample = [](const std::array<HaloSet, kNodeKinds>& nodes) {
    return !(kSampled[kCorner] - nodes[kCorner]).any() &&
           !(kSampled[kCentre] - nodes[kCentre]).any();
  };
  const bool none_inside = !inside[kCorner].any() && !inside[kCentre].any();
  return none_inside || every_sample(inside);
}

void find_cut_points(const BrickSamples& samples,
                     PhiSampler& sampler,
                     BrickCoord brick,
                     CutPoints& cuts) noexcept {
  const NodeSigns& signs = cuts.signs;
  for (int family = 0; family < kEdgeFamilies; ++family) {
    const auto f = static_cast<std::size_t>(family);
    const NodeKind kind = family_kind(family);
    const NodeKind end = end_kind(kind, family_direction(family));
    const int offset = end_offset(kind, family_direction(family));
    cuts.cut[f] = ((signs.inside[kind] & seen_from(signs.outside[end], offset)) |
                   (signs.outside[kind] & seen_from(signs.inside[end], offset))) &
                  kEdgesInReach[f];
    find_fractions(samples, sampler, brick, family, cuts);
  }
}

}  // namespace tet
