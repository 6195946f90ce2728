// Boundary faces of a brick's tets, noted while those are made.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/brick_mask.h"
#include "core/lattice/bcc.h"

namespace tet {

/// A face of one of a brick's tets.
struct LocalFace {
  std::uint32_t tet = 0;      ///< its number within the brick
  std::uint8_t opposite = 0;  ///< the corner that it is opposite of, as the tet is written
  std::uint8_t label = 0;     ///< see face_labels_of
  friend auto operator<=>(const LocalFace&, const LocalFace&) = default;
};

class LocalFaces {
 public:
  void clear() noexcept { count_ = 0; }
  void add(std::size_t tet, std::size_t opposite, std::uint8_t label = 0) noexcept {
    face_[count_++] = {static_cast<std::uint32_t>(tet), static_cast<std::uint8_t>(opposite),
                       label};
  }
  /// The last two corners of every tet have changed places.
  void mirror() noexcept {
    for (LocalFace& face : noted()) {
      if (face.opposite >= 2) face.opposite = static_cast<std::uint8_t>(5 - face.opposite);
    }
  }
  /// Puts them in the order of tets, and of the corners opposite.
  void sort() noexcept { std::ranges::sort(noted()); }
  std::span<const LocalFace> all() const noexcept { return std::span(face_).first(count_); }

 private:
  /// A cut tet has a fan of four triangles on the surface and, with both regions, six at the
  /// domain's end at most; half pyramids, which need no cut tet beside them, have fewer.
  static constexpr std::size_t kMax = std::size_t{kBrickCells} * kTetShapes * 12;
  std::span<LocalFace> noted() noexcept { return std::span(face_).first(count_); }

  std::size_t count_ = 0;
  std::array<LocalFace, kMax> face_;
};

}  // namespace tet
