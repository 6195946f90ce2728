#include "core/second_order/curved_tet.h"

#include <algorithm>
#include <cstddef>

#include "core/base/tet_geometry.h"
#include "core/second_order/middle_nodes.h"

namespace tet {
namespace {

/// The tet as a quadratic in Bernstein's basis: control points for pairs of corners, relative
/// to the first corner. A middle node m of corners a and b has the control point 2m - (a + b)
/// / 2.
using ControlPoints = std::array<std::array<Vector, 4>, 4>;

ControlPoints control_points(const TenNodes& node) noexcept {
  ControlPoints control{};
  for (std::size_t i = 0; i < 4; ++i) control[i][i] = from_to(node[0], node[i]);
  for (std::size_t e = 0; e < 6; ++e) {
    const auto [i, j] = kTetEdges[e];
    const Vector m = from_to(node[0], node[4 + e]), &a = control[i][i], &b = control[j][j];
    control[i][j] = control[j][i] = {2 * m.x - (a.x + b.x) / 2, 2 * m.y - (a.y + b.y) / 2,
                                     2 * m.z - (a.z + b.z) / 2};
  }
  return control;
}

/// Derivatives along the edges from the first corner are linear: what the share of corner j
/// brings to the one along edge k is twice this.
Vector slope(const ControlPoints& control, std::size_t k, std::size_t j) noexcept {
  return control[k][j] - control[0][j];
}

/// Which coefficient a product of three shares belongs to: the number of its sorted corners
/// among the twenty.
struct TripleNumbers {
  std::array<std::array<std::array<std::size_t, 4>, 4>, 4> of{};
  std::array<double, 20> count{};  ///< orders of the same three corners

  constexpr TripleNumbers() {
    std::size_t next = 0;
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t b = a; b < 4; ++b) {
        for (std::size_t c = b; c < 4; ++c) {
          for (const auto& [i, j, k] :
               {std::array{a, b, c}, std::array{a, c, b}, std::array{b, a, c},
                std::array{b, c, a}, std::array{c, a, b}, std::array{c, b, a}}) {
            of[i][j][k] = next;
          }
          ++next;
        }
      }
    }
    for (const auto& plane : of) {
      for (const auto& row : plane) {
        for (const std::size_t number : row) count[number] += 1;
      }
    }
  }
};
constexpr TripleNumbers kTriples;

}  // namespace

JacobianCoefficients jacobian_coefficients(const TenNodes& node) noexcept {
  const ControlPoints control = control_points(node);
  JacobianCoefficients sum{};
  for (std::size_t a = 0; a < 4; ++a) {
    const Vector along_1 = slope(control, 1, a);
    for (std::size_t b = 0; b < 4; ++b) {
      const Vector across = cross(along_1, slope(control, 2, b));
      for (std::size_t c = 0; c < 4; ++c) {
        sum[kTriples.of[a][b][c]] += 8 * dot(across, slope(control, 3, c));
      }
    }
  }
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] /= kTriples.count[i];
  return sum;
}

double least_jacobian(const TenNodes& node) noexcept {
  const JacobianCoefficients coefficients = jacobian_coefficients(node);
  return *std::ranges::min_element(coefficients);
}

double volume_of(const TenNodes& node) noexcept {
  double sum = 0;
  for (const double coefficient : jacobian_coefficients(node)) sum += coefficient;
  return sum / (20 * 6);
}

double jacobian_at(const TenNodes& node, const std::array<double, 4>& shares) noexcept {
  const ControlPoints control = control_points(node);
  std::array<Vector, 3> along{};
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t j = 0; j < 4; ++j) {
      const Vector part = slope(control, k + 1, j);
      along[k] = {along[k].x + 2 * shares[j] * part.x, along[k].y + 2 * shares[j] * part.y,
                  along[k].z + 2 * shares[j] * part.z};
    }
  }
  return dot(cross(along[0], along[1]), along[2]);
}

}  // namespace tet
