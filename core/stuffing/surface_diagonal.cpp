#include "core/stuffing/surface_diagonal.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/base/vec3.h"
#include "core/base/vector_clones.h"

namespace tet {
namespace {

/// The four tets over an apex, side by side: those with the diagonal a-c, over a, b, c and
/// a, c, d, then those with b-d, over b, c, d and b, d, a. Passed by reference and always
/// inlined: what a vector is passed in depends on the processor.
using FourTets [[gnu::vector_size(4 * sizeof(double))]] = double;
using FourVectors = BasicVector<FourTets>;

[[gnu::always_inline]] inline void subtract(const FourVectors& u,
                                            const FourVectors& v,
                                            FourVectors& out) noexcept {
  out.x = u.x - v.x;
  out.y = u.y - v.y;
  out.z = u.z - v.z;
}

[[gnu::always_inline]] inline void multiply(const FourVectors& u,
                                            const FourVectors& v,
                                            FourVectors& cross) noexcept {
  cross.x = u.y * v.z - u.z * v.y;
  cross.y = u.z * v.x - u.x * v.z;
  cross.z = u.x * v.y - u.y * v.x;
}

[[gnu::always_inline]] inline void multiply(const FourVectors& u,
                                            const FourVectors& v,
                                            FourTets& dot) noexcept {
  dot = u.x * v.x + u.y * v.y + u.z * v.z;
}

/// The corners after the apex, of all four tets: each takes one of the quad's.
struct Corners {
  FourVectors b, c, d;

  [[gnu::always_inline]] explicit Corners(const FourVectors& quad) noexcept {
    const auto choose = [](const FourTets& of, FourTets& in_b, FourTets& in_c, FourTets& in_d)
        __attribute__((always_inline)) {
      in_b = __builtin_shufflevector(of, of, 0, 0, 1, 1);
      in_c = __builtin_shufflevector(of, of, 1, 2, 2, 3);
      in_d = __builtin_shufflevector(of, of, 2, 3, 3, 0);
    };
    choose(quad.x, b.x, c.x, d.x);
    choose(quad.y, b.y, c.y, d.y);
    choose(quad.z, b.z, c.z, d.z);
  }
};

/// Normals of the faces, as face_normals has them.
struct Normals {
  std::array<FourVectors, 4> of;

  [[gnu::always_inline]] Normals(const FourVectors& quad, const FourVectors& apex) noexcept {
    const Corners corner(quad);
    FourVectors from_apex, bd, bc;
    subtract(quad, apex, from_apex);
    const Corners to(from_apex);
    subtract(corner.d, corner.b, bd);
    subtract(corner.c, corner.b, bc);
    multiply(bd, bc, of[0]);
    multiply(to.c, to.d, of[1]);
    multiply(to.d, to.b, of[2]);
    multiply(to.b, to.c, of[3]);
  }
};

/// Raises `worst` to the largest weighted square of the cosines of each tet's dihedral angles.
[[gnu::always_inline]] inline void add_worst_angles(const Normals& normal,
                                                    FourTets& worst) noexcept {
  const FourTets none{}, acute = none + 1.0, obtuse = none + kObtuseWeight;
  std::array<FourTets, 4> square;
  for (std::size_t i = 0; i < 4; ++i) multiply(normal.of[i], normal.of[i], square[i]);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = i + 1; j < 4; ++j) {
      FourTets cosine;  // times -1, and the areas
      multiply(normal.of[i], normal.of[j], cosine);
      const FourTets weight = cosine > none ? obtuse : acute;
      const FourTets angle = weight * (cosine * cosine / (square[i] * square[j]));
      worst = angle > worst ? angle : worst;
    }
  }
}

}  // namespace

TET_VECTOR_CLONES
bool second_diagonal_is_better(std::span<const WorldPoint> apexes,
                               const WorldPoint& a,
                               const WorldPoint& b,
                               const WorldPoint& c,
                               const WorldPoint& d) noexcept {
  const FourVectors quad{{a.x, b.x, c.x, d.x}, {a.y, b.y, c.y, d.y}, {a.z, b.z, c.z, d.z}};
  const FourTets zero{};
  FourTets worst{};
  for (const WorldPoint& apex : apexes) {
    add_worst_angles(Normals(quad, {zero + apex.x, zero + apex.y, zero + apex.z}), worst);
  }
  return std::max(worst[2], worst[3]) < std::max(worst[0], worst[1]);
}

}  // namespace tet
