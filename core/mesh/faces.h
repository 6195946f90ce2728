// The faces of a tet, and what boundary and conformity both need to know of them.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace tet {

using Triangle = std::array<std::uint64_t, 3>;

/// Corners of the face opposite each corner of a positive tet, counter-clockwise seen from
/// outside.
inline constexpr std::array<std::array<std::uint8_t, 3>, 4> kFaceCorners{
    {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

inline Triangle face_of(const std::array<std::uint64_t, 4>& tet,
                        std::size_t opposite) noexcept {
  const auto& corner = kFaceCorners[opposite];
  return {tet[corner[0]], tet[corner[1]], tet[corner[2]]};
}

/// The corner of a tet that one of its faces is opposite of; 0 for a triangle that is none.
inline std::size_t opposite_corner(const std::array<std::uint64_t, 4>& tet,
                                   const Triangle& face) noexcept {
  const auto corner = std::ranges::find_if(
      tet, [&](std::uint64_t vertex) { return std::ranges::find(face, vertex) == face.end(); });
  return corner == tet.end() ? 0 : static_cast<std::size_t>(corner - tet.begin());
}

/// A triangle in a form that is the same from both sides, but for `flipped`.
struct SortedFace {
  Triangle vertices{};   ///< ascending
  bool flipped = false;  ///< the triangle runs through them in the opposite direction

  friend auto operator<=>(const SortedFace&, const SortedFace&) = default;

  /// The triangle again, starting at its smallest vertex.
  Triangle triangle() const noexcept {
    const auto [a, b, c] = vertices;
    return flipped ? Triangle{a, c, b} : Triangle{a, b, c};
  }
};

inline SortedFace sort_face(Triangle t) noexcept {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  const bool flipped = t[1] > t[2];
  if (flipped) std::swap(t[1], t[2]);
  return {t, flipped};
}

}  // namespace tet
