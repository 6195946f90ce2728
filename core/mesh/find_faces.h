// The boundary faces of a whole mesh, found from its tets alone: for meshes that are made
// whole, for files, and to check those that come with chunks.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/base/cancel.h"
#include "core/mesh/face_search.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// The faces that belong to one tet alone, and those between inside and outside, once, as the
/// inside's; of a mesh with labels those between two of them. In the order of `index`.
/// Parallel. Once `cancellation` is requested it ends soon, and what it returns means nothing.
std::vector<TetFace> find_boundary_faces(const TetMesh& mesh,
                                         const Cancellation& cancellation = {});

/// Labels of the faces of one grid's mesh: the surface, or what lies between both sides, and
/// then the six faces of the box that the mesh ends at.
std::vector<FaceLabel> face_labels_of(bool both_sides, bool in_box);

/// Adds the regions that a request names, and their labels behind all others.
void add_region_labels(std::span<const FaceRegion> regions, MeshHeader& header);

/// Those of one grid's mesh for each of several parts: `<part>_<name>`, part by part.
std::vector<FaceLabel> labels_of_parts(std::span<const FaceLabel> of_one,
                                       std::span<const MeshPart> parts);

/// The place of the label of a face of the box among face_labels_of; `face` is the number of a
/// bit of CutFace.
constexpr std::uint16_t label_of_box_face(std::size_t face) noexcept {
  return static_cast<std::uint16_t>(1 + face);
}

/// The label of a face whose vertices all lie in some faces of the box, CutFaces: that of the
/// first, or of the surface where they share none.
constexpr std::uint16_t label_of_cut(std::uint32_t shared) noexcept {
  return shared == 0 ? std::uint16_t{0}
                     : label_of_box_face(static_cast<std::size_t>(std::countr_zero(shared)));
}

/// Which label a face has.
using LabelFace = std::function<std::uint16_t(const TetFace&, const Triangle&)>;

/// Faces with their labels, beside the mesh that they are of.
struct FoundFaces {
  std::vector<TetFace> faces;
  std::vector<FaceLabel> labels;
  LabelFace label;  ///< refers to the mesh
};

/// Whether a box cuts the mesh: its vertices say in which of the box's faces they lie.
bool has_cut_faces(const MeshHeader& header) noexcept;

/// Finds the faces of a mesh, and labels them by what it says: its regions, its parts, and the
/// array `cut_face` of its vertices. Faces where both sides end are those of the face of the
/// box around all vertices that they are next to: right where the lattice lies along the axes.
/// Once `cancellation` is requested it ends soon, and what it returns means nothing.
FoundFaces find_faces(const TetMesh& mesh, const Cancellation& cancellation = {});

/// Writes the columns, and in the header labels and count, of faces that were found in `mesh`,
/// to `to`: the same mesh, or one that has its types and count of tets. Parallel.
void set_faces(const FoundFaces& found, const TetMesh& mesh, TetMesh& to);

/// Gives a mesh that has none its faces.
inline void add_faces(TetMesh& mesh) { set_faces(find_faces(mesh), mesh, mesh); }

}  // namespace tet
