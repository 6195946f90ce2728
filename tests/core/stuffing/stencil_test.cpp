#include "core/stuffing/stencil.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace tet {
namespace {

struct Point {
  double x, y, z;
};

double volume(const Point& a, const Point& b, const Point& c, const Point& d) {
  const Point u{b.x - a.x, b.y - a.y, b.z - a.z}, v{c.x - a.x, c.y - a.y, c.z - a.z},
      w{d.x - a.x, d.y - a.y, d.z - a.z};
  return (u.x * (v.y * w.z - v.z * w.y) - u.y * (v.x * w.z - v.z * w.x) +
          u.z * (v.x * w.y - v.y * w.x)) /
         6;
}

constexpr std::array<Point, 4> kNode{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

using Fractions =
    std::array<double, 6>;  ///< of the cut point on each edge, from its lower node

Point place(StencilVertex vertex, const Fractions& fraction) {
  if (vertex < 4) return kNode[vertex];
  const std::size_t edge = static_cast<std::size_t>(vertex - 4);
  const Point &a = kNode[kTetEdge[edge][0]], &b = kNode[kTetEdge[edge][1]];
  const double t = fraction[edge];
  return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.z + t * (b.z - a.z)};
}

int sign_of(std::size_t number, std::size_t node) {
  for (std::size_t i = 0; i < node; ++i) number /= 3;
  return static_cast<int>(number % 3);  // 0 -, 1 zero, 2 +
}

std::size_t count_of(std::size_t number, int sign) {
  std::size_t count = 0;
  for (std::size_t node = 0; node < 4; ++node) count += sign_of(number, node) == sign;
  return count;
}

/// Column choices that lengths can give: never a cycle.
bool possible(std::size_t number, std::size_t choice) {
  const bool three_plus = count_of(number, 2) == 3, has_minus = count_of(number, 0) > 0;
  const bool two_two = count_of(number, 2) == 2 && count_of(number, 0) == 2;
  const bool first = choice & 1, second = choice >> 1 & 1, third = choice >> 2 & 1;
  // +++-: p beats q, q beats r, so r may not beat p; and the other way round.
  if (three_plus && has_minus) return !(first == third && second != first);
  if (two_two) return first == second || third == second;
  return true;
}

TEST(Stencil, HasOnlyPositiveTets) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> cut(0.05, 0.95);
  for (std::size_t number = 0; number < kStencilCases; ++number) {
    for (std::size_t choice = 0; choice < kStencilChoices; ++choice) {
      if (!possible(number, choice)) continue;
      for (int trial = 0; trial < 20; ++trial) {
        Fractions fraction;
        for (double& f : fraction) f = cut(random);
        const Stencil& stencil = kStencils[number][choice];
        for (std::size_t t = 0; t < stencil.tet_count; ++t) {
          const auto [a, b, c, d] = stencil.tet[t];
          const double v = volume(place(a, fraction), place(b, fraction), place(c, fraction),
                                  place(d, fraction));
          EXPECT_GT(v, 0) << "case " << number << " choice " << choice << " tet " << t;
        }
      }
    }
  }
}

TEST(Stencil, FillsTheInsidePartWhenTheSurfaceIsFlat) {
  // With phi linear in the tet the cut points lie in one plane, and volumes must add up.
  std::mt19937 random(2);
  std::uniform_real_distribution<double> value(0.1, 1);
  for (std::size_t number = 0; number < kStencilCases; ++number) {
    for (std::size_t choice = 0; choice < kStencilChoices; ++choice) {
      if (!possible(number, choice) || count_of(number, 2) == 0) continue;
      std::array<double, 4> phi;
      for (std::size_t node = 0; node < 4; ++node) {
        phi[node] = value(random) * (1 - sign_of(number, node));  // + is inside: negative
      }
      Fractions fraction{};
      for (std::size_t e = 0; e < 6; ++e) {
        const double a = phi[kTetEdge[e][0]], b = phi[kTetEdge[e][1]];
        if (a * b < 0) fraction[e] = a / (a - b);
      }
      double filled = 0;
      const Stencil& stencil = kStencils[number][choice];
      for (std::size_t t = 0; t < stencil.tet_count; ++t) {
        const auto [a, b, c, d] = stencil.tet[t];
        filled += volume(place(a, fraction), place(b, fraction), place(c, fraction),
                         place(d, fraction));
      }
      // Cutting one node off takes the product of its three fractions; inside or outside is
      // small.
      const bool one_inside = count_of(number, 2) == 1;
      const std::size_t apart = one_inside ? 1 : count_of(number, 0);
      if (apart != 1) continue;  // ++--: checked by positive tets that share faces properly
      double corner = 1.0 / 6;
      const int apart_sign = one_inside ? 2 : 0;
      for (std::size_t node = 0; node < 4; ++node) {
        if (sign_of(number, node) != apart_sign) continue;
        for (std::size_t other = 0; other < 4; ++other) {
          if (other == node || sign_of(number, other) == apart_sign) continue;
          const double p = phi[node], q = phi[other];
          corner *= q == 0 ? 1 : p / (p - q);
        }
      }
      EXPECT_NEAR(filled, one_inside ? corner : 1.0 / 6 - corner, 1e-12)
          << "case " << number << " choice " << choice;
    }
  }
}

/// Triangles of a stencil that lie on the face opposite `node`, each as sorted labels. Labels
/// name nodes and edges by their nodes, so that two tets that share a face speak alike.
using Label = std::pair<std::size_t, std::size_t>;
using FaceTriangles = std::set<std::array<Label, 3>>;

Label label_of(StencilVertex vertex) {
  if (vertex < 4) return {vertex, vertex};
  const auto edge = kTetEdge[static_cast<std::size_t>(vertex - 4)];
  return {edge[0], edge[1]};
}

FaceTriangles triangles_on_face(const Stencil& stencil, std::size_t node) {
  FaceTriangles triangles;
  for (std::size_t t = 0; t < stencil.tet_count; ++t) {
    for (std::size_t skip = 0; skip < 4; ++skip) {
      std::array<Label, 3> face;
      std::size_t next = 0;
      bool on_face = true;
      for (std::size_t i = 0; i < 4; ++i) {
        if (i == skip) continue;
        const Label label = label_of(stencil.tet[t][i]);
        on_face = on_face && label.first != node && label.second != node;
        face[next++] = label;
      }
      std::sort(face.begin(), face.end());
      if (on_face) triangles.insert(face);
    }
  }
  return triangles;
}

/// The choice that column lengths give, with fractions from each + node.
std::size_t choice_for(std::size_t number, const Fractions& fraction) {
  std::vector<std::size_t> plus, minus;
  for (std::size_t node = 0; node < 4; ++node) {
    if (sign_of(number, node) == 2) plus.push_back(node);
    if (sign_of(number, node) == 0) minus.push_back(node);
  }
  const auto length = [&](std::size_t p, std::size_t m) {
    const double t = fraction[edge_between(p, m)];
    return p < m ? t : 1 - t;
  };
  const auto longer = [&](std::size_t q, std::size_t p, std::size_t m) {
    return std::size_t{length(q, m) > length(p, m)};
  };
  if (plus.size() < 2 || minus.empty()) return 0;
  const std::size_t first = longer(plus[1], plus[0], minus[0]);
  if (plus.size() == 3) {
    return first | longer(plus[2], plus[0], minus[0]) << 1 |
           longer(plus[2], plus[1], minus[0]) << 2;
  }
  if (minus.size() < 2) return first;
  const std::size_t second = longer(plus[1], plus[0], minus[1]);
  return first | second << 1 | (first == second ? 0 : second) << 2;
}

TEST(Stencil, SplitsAFaceTheSameWhateverLiesBehindIt) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> cut(0.05, 0.95);
  for (int trial = 0; trial < 200; ++trial) {
    Fractions fraction;
    for (double& f : fraction) f = cut(random);
    // The face of nodes 0, 1, 2 with every sign of the node 3 behind it; the edges to that node
    // differ too, as they do between two tets.
    for (std::size_t face_signs = 0; face_signs < 27; ++face_signs) {
      std::optional<FaceTriangles> seen;
      for (std::size_t behind = 0; behind < 3; ++behind) {
        const std::size_t number = face_signs + 27 * behind;
        Fractions own = fraction;
        for (const std::size_t edge : {2, 4, 5}) own[edge] = cut(random);
        const Stencil& stencil = kStencils[number][choice_for(number, own)];
        if (stencil.tet_count == 0) continue;
        const FaceTriangles triangles = triangles_on_face(stencil, 3);
        // A face with no + has no inside part; it is the boundary of the other side, if
        // anything.
        if (count_of(face_signs + 27, 2) == 0) continue;
        if (!seen) seen = triangles;
        EXPECT_EQ(*seen, triangles) << "face " << face_signs << " behind " << behind;
      }
    }
  }
}

TEST(Stencil, HasAsManyTetsAsTheRulesSay) {
  for (std::size_t number = 0; number < kStencilCases; ++number) {
    const std::size_t plus = count_of(number, 2), minus = count_of(number, 0);
    std::size_t expected = 3;
    if (plus == 0) {
      expected = 0;
    } else if (minus == 0 || plus == 1) {
      expected = 1;
    } else if (plus == 2 && minus == 1) {
      expected = 2;
    }
    for (std::size_t choice = 0; choice < kStencilChoices; ++choice) {
      EXPECT_EQ(kStencils[number][choice].tet_count, expected) << "case " << number;
    }
  }
}

}  // namespace
}  // namespace tet
