// Triangles cut into pieces no longer than an edge.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "core/base/types.h"

namespace tet {

using CutTriangle = std::array<WorldPoint, 3>;

/// A triangle that is cut across its longest side, from `a` to `b`, at equal steps.
struct SlicedTriangle {
  WorldPoint a, b, c;
  double top = 0;  ///< the part of the way from `a` to `b` at which `c` lies
  std::size_t slices = 1;
  bool are_pieces = false;  ///< no slice has a longer side than is wanted

  /// Calls `visit(triangle)` for the triangles of each slice.
  template <class Visit>
  void for_each_triangle(const Visit& visit) const {
    WorldPoint low = a, high = a;  // ends of the cut before: on the longest side, and beyond
    double before = 0;
    for (std::size_t i = 1; i <= slices; ++i) {
      const bool is_first = i == 1, is_last = i == slices;
      const double part = is_last ? 1 : static_cast<double>(i) / static_cast<double>(slices);
      const WorldPoint next = is_last ? b : low_end(part),
                       next_high = is_last ? b : high_end(part);
      if (before <= top && (top < part || is_last)) {
        if (!is_first && before < top) visit(CutTriangle{low, c, high});
        visit(CutTriangle{low, next, c});
        if (!is_last) visit(CutTriangle{next, next_high, c});
      } else {
        if (!is_last) visit(CutTriangle{low, next, next_high});
        if (!is_first) visit(CutTriangle{low, next_high, high});
      }
      low = next;
      high = next_high;
      before = part;
    }
  }

 private:
  WorldPoint low_end(double part) const noexcept;
  WorldPoint high_end(double part) const noexcept;
};

/// Cuts one triangle after another. The longest side is halved until none is longer than
/// `edge`; but a needle, of which halves would be needles again and again, is cut across. So
/// there are about as many pieces as area / edge^2 + length / edge.
class TriangleCutter {
 public:
  explicit TriangleCutter(double edge) : edge_(edge) {}

  /// Calls `visit(piece)` for each piece; they are wound as the triangle is.
  template <class Visit>
  void for_each_piece(const CutTriangle& triangle, const Visit& visit) {
    waiting_.assign(1, triangle);
    while (!waiting_.empty()) {
      const CutTriangle t = waiting_.back();
      waiting_.pop_back();
      if (const auto slices = slices_of(t)) {
        slices->for_each_triangle([&](const CutTriangle& part) {
          if (slices->are_pieces) {
            visit(part);
          } else {
            waiting_.push_back(part);
          }
        });
      } else if (!halve(t)) {
        visit(t);
      }
    }
  }

  /// Returns a number of pieces that there are no fewer of.
  double least_pieces(const CutTriangle& triangle) const noexcept;

 private:
  std::optional<SlicedTriangle> slices_of(const CutTriangle& t) const noexcept;
  /// False where it is short enough.
  bool halve(const CutTriangle& t);

  double edge_;
  std::vector<CutTriangle> waiting_;
};

}  // namespace tet
