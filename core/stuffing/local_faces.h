// Boundary faces of a brick's tets, noted while those are made.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "core/base/brick_mask.h"
#include "core/base/local_point.h"
#include "core/lattice/bcc.h"

namespace tet {

/// A face of one of a brick's tets. Without initial values: clearing room for the faces of all
/// tets would touch 1.2 MB for each mesh.
struct LocalFace {
  std::uint32_t tet;      ///< its number within the brick
  std::uint8_t opposite;  ///< the corner that it is opposite of, as the tet is written
  std::uint8_t label;     ///< see face_labels_of
  LocalTet corners;       ///< of the tet, as it is written; only of faces of the surface
  friend auto operator<=>(const LocalFace&, const LocalFace&) = default;
};

class LocalFaces {
 public:
  void clear() noexcept { count_ = 0; }
  /// Adds one in a face of the domain.
  void add(std::size_t tet, std::size_t opposite, std::uint8_t label) noexcept {
    note(tet, opposite, label, {});
  }
  /// Adds one of the surface.
  void add_on_surface(std::size_t tet, std::size_t opposite, const LocalTet& corners) noexcept {
    note(tet, opposite, 0, corners);
  }
  /// Adds one of the surface where `opposite` is a corner, and none where it is 4. It does not
  /// branch: whether there is one changes from tet to tet.
  void add_if_on_surface(std::size_t tet,
                         std::size_t opposite,
                         const LocalTet& corners) noexcept {
    note(tet, opposite, 0, corners);
    count_ -= opposite >> 2;
  }
  /// The last two corners of every tet have changed places.
  void mirror() noexcept {
    for (LocalFace& face : noted()) {
      if (face.opposite >= 2) face.opposite = static_cast<std::uint8_t>(5 - face.opposite);
      std::swap(face.corners[2], face.corners[3]);
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
  /// Member by member: a whole face would be put together in memory and read back across the
  /// parts it was written in, which waits for all of them.
  void note(std::size_t tet,
            std::size_t opposite,
            std::uint8_t label,
            const LocalTet& corners) noexcept {
    LocalFace& face = face_[count_++];
    face.tet = static_cast<std::uint32_t>(tet);
    face.opposite = static_cast<std::uint8_t>(opposite);
    face.label = label;
    face.corners = corners;
  }

  std::size_t count_ = 0;
  std::array<LocalFace, kMax + 1> face_;  // one that was not to be added may be written
};

}  // namespace tet
