// Which faces of a mesh's tets are its boundary, or lie between groups of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/cancel.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// Behind a face that belongs to one tet alone there is no label.
inline constexpr LabelNumber kNoLabelBehind = 0xffff;

/// A face as one of a tet's four.
struct TetFace {
  /// 4 * tet + the corner that the face is opposite of.
  std::uint64_t index = 0;
  bool is_interface = false;  ///< the tet is inside, and the one behind it outside
  /// What lies behind an interface, of a mesh with labels.
  LabelNumber behind = kNoLabelBehind;

  std::uint64_t tet() const noexcept { return index / 4; }
  std::size_t opposite() const noexcept { return index % 4; }
  friend bool operator==(const TetFace&, const TetFace&) = default;
};

/// Finds faces in two steps: how much memory the second takes is known after the first. Both
/// are parallel; once `cancellation` is requested they end soon, and what they say means
/// nothing. The mesh and the cancellation must outlive it.
class FaceSearch {
 public:
  /// Counts the candidates: faces whose vertices all have something around them that is seen
  /// from one side alone.
  FaceSearch(const TetMesh& mesh, const Cancellation& cancellation);

  /// Memory that the search takes beside the mesh, bytes, with the columns that become of what
  /// it finds.
  std::uint64_t bytes() const noexcept {
    return bytes_of(mesh_.header.vertex_count, first_.back());
  }
  /// Says so of a mesh of so many vertices, with so many candidates.
  static std::uint64_t bytes_of(std::uint64_t vertices, std::uint64_t candidates) noexcept;

  /// The faces that belong to one tet alone, and those between groups, once, as the lower
  /// group's: inside and outside, or the labels. In the order of `index`. To be called once.
  std::vector<TetFace> find();

 private:
  const TetMesh& mesh_;
  const Cancellation& cancellation_;
  std::vector<std::uint64_t> seen_;   // around each vertex
  std::vector<std::uint64_t> first_;  // candidate of each range of tets, and one more
};

}  // namespace tet
