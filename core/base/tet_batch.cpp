#include "core/base/tet_batch.h"

#include <cmath>

#include "core/base/tet_geometry.h"
#include "core/base/vector_clones.h"

namespace tet {
namespace {

using FloatVector = BasicVector<float>;

// Unlike std::min and std::max these become one instruction. The second number wins when the
// first is none.
float lower(float a, float b) noexcept { return a < b ? a : b; }
float higher(float a, float b) noexcept { return a > b ? a : b; }

struct Face {
  FloatVector normal;
  float per_square;  // 1 / |normal|^2

  explicit Face(const FloatVector& n) noexcept : normal(n), per_square(1 / dot(n, n)) {}
};

/// Of the dihedral angle between two faces.
[[gnu::always_inline]] inline float signed_square_of_cosine(const Face& f,
                                                            const Face& g) noexcept {
  const float inward = -dot(f.normal, g.normal);
  return higher((inward * f.per_square) * (std::abs(inward) * g.per_square), -1);
}

}  // namespace

TET_VECTOR_CLONES
void measure_batch(const TetBatch& __restrict batch, BatchAngles& __restrict angles) noexcept {
  const auto& [ab, ac, ad] = batch.edge;
  for (std::size_t i = 0; i < TetBatch::kSize; ++i) {
    const FloatVector u{ab.x[i], ab.y[i], ab.z[i]}, v{ac.x[i], ac.y[i], ac.z[i]};
    const FloatVector w{ad.x[i], ad.y[i], ad.z[i]};
    const Face a(cross(w - u, v - u)), b(cross(v, w)), c(cross(w, u)), d(cross(u, v));
    const std::array<float, 6> cosine{
        signed_square_of_cosine(a, b), signed_square_of_cosine(a, c),
        signed_square_of_cosine(a, d), signed_square_of_cosine(b, c),
        signed_square_of_cosine(b, d), signed_square_of_cosine(c, d)};
    float largest = cosine[0], smallest = cosine[0];
#pragma GCC unroll 6  // inner loops would keep the outer one from becoming vector instructions
    for (std::size_t edge = 0; edge < 6; ++edge) {
      angles.cosine[edge][i] = cosine[edge];
      largest = higher(largest, cosine[edge]);
      smallest = lower(smallest, cosine[edge]);
    }
    angles.largest_cosine[i] = largest;
    angles.smallest_cosine[i] = smallest;
    angles.six_volumes[i] = dot(u, b.normal);
  }
}

}  // namespace tet
