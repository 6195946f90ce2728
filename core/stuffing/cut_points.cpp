#include "core/stuffing/cut_points.h"

#include <algorithm>
#include <cstddef>

#include "core/base/vector_clones.h"
#include "core/stuffing/scene_zeros.h"

namespace tet {
namespace {

using Lanes = std::array<float, kEdgeLanes>;

/// Edges are gathered this many at a time: so many that no column is read back while it is
/// still being written, few enough for the first-level cache.
constexpr std::size_t kBatch = 4 * kEdgeLanes;
using Column = std::array<float, kBatch>;

/// Zero of the line through (0, a) and (1, b), signs strictly opposite; in [0, 1].
float linear_zero(float a, float b) noexcept { return a / (a - b); }

/// Zeros of functions on [0, 1] that are `a` at 0 and `b` at 1: secant steps that keep a
/// bracket, for 16 functions at once.
struct Brackets {
  alignas(64) Lanes low{}, high, a, b, t;

  Brackets(const float* at_0, const float* at_1) noexcept {
    std::copy_n(at_0, kEdgeLanes, a.begin());
    std::copy_n(at_1, kEdgeLanes, b.begin());
    high.fill(1);
    for (std::size_t i = 0; i < kEdgeLanes; ++i) t[i] = linear_zero(a[i], b[i]);
  }

  /// Narrows bracket `i`, given that the function at `t` is `value`.
  void narrow(std::size_t i, float value) noexcept {
    const bool beyond = ((value < 0) == (a[i] < 0)) & (value != 0);
    const float new_low = beyond ? t[i] : low[i], new_a = beyond ? value : a[i];
    const float new_high = beyond ? high[i] : t[i], new_b = beyond ? b[i] : value;
    low[i] = new_low;
    high[i] = new_high;
    a[i] = new_a;
    b[i] = new_b;
    t[i] = new_low + (new_high - new_low) * linear_zero(new_a, new_b);
  }
};
constexpr int kSecantSteps = 2;

/// One family of edges: its ends' samples, by the lower node's halo index.
struct Family {
  NodeKind kind;
  int direction;
  const float* low_phi;
  const float* high_phi;

  Family(const BrickSamples& samples, int family) noexcept
      : kind(family_kind(family)), direction(family_direction(family)) {
    const auto phi = [&](NodeKind of) {
      return of == kCorner ? samples.corner.data() : samples.centre.data();
    };
    low_phi = phi(kind);
    high_phi = phi(end_kind(kind, direction)) + end_offset(kind, direction);
  }
};

/// Zeros on edges between two corners: the trilinear field is linear along a voxel's edge.
TET_VECTOR_CLONES
void zeros_between_corners(const Family& family,
                           const std::uint16_t* low,
                           std::size_t count,
                           float* fraction) noexcept {
  alignas(64) Column a, b;
  for (std::size_t i = 0; i < count; ++i) {
    a[i] = family.low_phi[low[i]];
    b[i] = family.high_phi[low[i]];
  }
  for (std::size_t i = 0; i < count; ++i) fraction[i] = linear_zero(a[i], b[i]);
}

/// Steps from a corner of a face across `axis` to the two corners beside it.
constexpr std::array<int, 2> steps_across(int axis) noexcept {
  constexpr std::array<int, 3> kStep{offset_index(1, 0, 0), offset_index(0, 1, 0),
                                     offset_index(0, 0, 1)};
  return {kStep[axis == 0 ? 1 : 0], kStep[axis == 2 ? 1 : 2]};
}

/// Zeros on edges between two centres: the trilinear field is linear on either side of the face
/// between them.
TET_VECTOR_CLONES
void zeros_through_faces(const BrickSamples& samples,
                         const Family& family,
                         const std::uint16_t* low,
                         std::size_t count,
                         float* fraction) noexcept {
  const auto [u, v] = steps_across(family.direction);
  const float* corner = samples.corner.data() + end_offset(kCorner, family.direction);
  alignas(64) Column a, b, middle;
  for (std::size_t i = 0; i < count; ++i) {
    const float* face = corner + low[i];
    a[i] = family.low_phi[low[i]];
    b[i] = family.high_phi[low[i]];
    middle[i] = 0.25F * ((face[0] + face[u]) + (face[v] + face[u + v]));
  }
  for (std::size_t i = 0; i < count; ++i) {
    const bool beyond = (middle[i] < 0) == (a[i] < 0);
    const float from = beyond ? middle[i] : a[i], to = beyond ? b[i] : middle[i];
    const float zero = (beyond ? 0.5F : 0.0F) + 0.5F * linear_zero(from, to);
    fraction[i] = middle[i] == 0 ? 0.5F : zero;
  }
}

/// The trilinear field along a short edge, a cubic: by the cell's vertices at the corner, next
/// to it, next to the vertex across, and across.
struct Diagonals {
  alignas(64) Column a, b, near_sum, far_sum, far;
};

/// A short edge's corner as a vertex of its cell: from the lower node, and the steps away from
/// it along the axes.
struct CellVertex {
  int offset, x, y, z;

  explicit CellVertex(const Family& family) noexcept {
    const int end = end_offset(family.kind, family.direction);
    offset = family.kind == kCorner ? 0 : end;
    const int in_cell = family.kind == kCorner ? -end : end;  // each coordinate 0 or 1
    x = in_cell & 256 ? -256 : 256;
    y = in_cell & 16 ? -16 : 16;
    z = in_cell & 1 ? -1 : 1;
  }
};

void gather_diagonals(const BrickSamples& samples,
                      const Family& family,
                      const std::uint16_t* low,
                      std::size_t count,
                      Diagonals& out) noexcept {
  const auto [offset, x, y, z] = CellVertex(family);
  const float* corner = samples.corner.data() + offset;
  for (std::size_t i = 0; i < count; ++i) {
    const float* phi = corner + low[i];
    out.a[i] = family.low_phi[low[i]];
    out.b[i] = family.high_phi[low[i]];
    out.near_sum[i] = phi[x] + phi[y] + phi[z];
    out.far_sum[i] = phi[x + y] + phi[x + z] + phi[y + z];
    out.far[i] = phi[x + y + z];
  }
}

/// Zeros on short edges.
TET_VECTOR_CLONES
void zeros_on_diagonals(const BrickSamples& samples,
                        const Family& family,
                        const std::uint16_t* low,
                        std::size_t count,
                        float* fraction) noexcept {
  Diagonals field;
  gather_diagonals(samples, family, low, count, field);
  const bool from_corner = family.kind == kCorner;
  const Column& here = from_corner ? field.a : field.b;
  // How far along the cell's diagonal, from the corner: 0.5 * t, or 0.5 * (1 - t).
  const float start = from_corner ? 0.0F : 0.5F, slope = from_corner ? 0.5F : -0.5F;
  for (std::size_t first = 0; first < count; first += kEdgeLanes) {
    Brackets zero(&field.a[first], &field.b[first]);
    for (int step = 0; step < kSecantSteps; ++step) {
      for (std::size_t i = 0; i < kEdgeLanes; ++i) {
        const std::size_t e = first + i;
        const float s = start + slope * zero.t[i], r = 1 - s;
        zero.narrow(i, r * r * (r * here[e] + s * field.near_sum[e]) +
                           s * s * (r * field.far_sum[e] + s * field.far[e]));
      }
    }
    std::copy(zero.t.begin(), zero.t.end(), fraction + first);
  }
}

/// Zeros on any edges of a lattice that does not sit on the voxels: phi is asked for.
TET_VECTOR_CLONES
void zeros_of_field(PhiSampler& sampler,
                    BrickCoord brick,
                    const Family& family,
                    const std::uint16_t* low,
                    std::size_t count,
                    float* fraction) noexcept {
  static_assert(PhiSampler::kPoints == kEdgeLanes);
  const LatticeCoord along = kDirection[static_cast<std::size_t>(family.direction)];
  const double along_x = along.x, along_y = along.y, along_z = along.z;
  const double x = 8.0 * brick.x, y = 8.0 * brick.y, z = 8.0 * brick.z;
  for (std::size_t first = 0; first < count; first += kEdgeLanes) {
    alignas(64) Lanes a, b;
    PhiSampler::Points from, points;
    for (std::size_t i = 0; i < kEdgeLanes; ++i) {
      a[i] = family.low_phi[low[first + i]];
      b[i] = family.high_phi[low[first + i]];
      const LatticeCoord node = node_coord(family.kind, low[first + i]);
      from.x[i] = node.x;
      from.y[i] = node.y;
      from.z[i] = node.z;
    }
    Brackets zero(a.data(), b.data());
    for (int step = 0; step < kSecantSteps; ++step) {
      for (std::size_t i = 0; i < kEdgeLanes; ++i) {
        const double s = static_cast<double>(zero.t[i]);
        points.x[i] = x + 0.5 * (from.x[i] + s * along_x);
        points.y[i] = y + 0.5 * (from.y[i] + s * along_y);
        points.z[i] = z + 0.5 * (from.z[i] + s * along_z);
      }
      sampler.sample_points(brick, points);
      for (std::size_t i = 0; i < kEdgeLanes; ++i) zero.narrow(i, points.phi[i]);
    }
    std::copy(zero.t.begin(), zero.t.end(), fraction + first);
  }
}

/// Zeros on any edges of a scene.
void zeros_of_scene(PhiSampler& sampler,
                    BrickCoord brick,
                    const Family& family,
                    const std::uint16_t* low,
                    std::size_t count,
                    float* fraction) noexcept {
  static_assert(kBatch <= kSceneEdges);
  alignas(64) Column a, b;
  for (std::size_t i = 0; i < count; ++i) {
    a[i] = family.low_phi[low[i]];
    b[i] = family.high_phi[low[i]];
  }
  find_scene_zeros(sampler,
                   {brick, family.kind, family.direction, {low, count}, a.data(), b.data()},
                   fraction);
}

/// Up to kBatch edges of a family, by their low ends, and where their fractions go. `count` is
/// a multiple of kEdgeLanes.
struct EdgeBatch {
  const Family& family;
  const std::uint16_t* low;
  std::size_t count;
  float* fraction;
};

void find_fractions(const BrickSamples& samples,
                    PhiSampler& sampler,
                    BrickCoord brick,
                    const EdgeBatch& batch) noexcept {
  const auto& [family, low, count, fraction] = batch;
  if (sampler.field().scene != nullptr) {
    zeros_of_scene(sampler, brick, family, low, count, fraction);
  } else if (!sampler.field().at_voxels()) {
    zeros_of_field(sampler, brick, family, low, count, fraction);
  } else if (!is_long(family.direction)) {
    zeros_on_diagonals(samples, family, low, count, fraction);
  } else if (family.kind == kCentre) {
    zeros_through_faces(samples, family, low, count, fraction);
  } else {
    zeros_between_corners(family, low, count, fraction);
  }
}

}  // namespace

void find_cut_points(const BrickSamples& samples,
                     PhiSampler& sampler,
                     BrickCoord brick,
                     CutPoints& cuts) noexcept {
  CutEdges& edges = cuts.edges;
  find_cut_edges(cuts.signs, cuts.cut, edges);
  for (std::size_t f = 0; f < kEdgeFamilies; ++f) {
    const Family family(samples, static_cast<int>(f));
    const auto [begin, count] = edges.run[f];
    const std::size_t end = begin + edges.run[f].padded();
    for (std::size_t first = begin; first < end; first += kBatch) {
      find_fractions(
          samples, sampler, brick,
          {family, &edges.low[first], std::min(kBatch, end - first), &edges.fraction[first]});
    }
    for (std::size_t i = begin; i < begin + count; ++i) {
      cuts.fraction[f][edges.low[i]] = edges.fraction[i];
    }
  }
}

}  // namespace tet
