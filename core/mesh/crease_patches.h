// Faces with one name in patches between the creases of a surface.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/cancel.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// The faces of one label, each in a patch or in none.
struct CreasePatches {
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  std::vector<std::uint64_t> faces = {};  ///< numbers in the mesh, ascending
  /// Says of each of `faces` which patch has it. They are numbered from 0 on: the one with the
  /// most faces first, and of those of one size the one with the lowest face.
  std::vector<std::uint32_t> patch = {};
  std::uint32_t count = 0;
};

/// Memory that finding patches takes for a face, bytes.
inline constexpr std::uint64_t kPatchBytesPerFace = 112;

/// Faces are numbered in four bytes.
inline constexpr std::uint64_t kMostPatchedFaces = CreasePatches::kNone - std::uint64_t{1};

/// Finds the patches of a label's faces, at most kMostPatchedFaces. `surface` is a mesh of
/// which nothing but its faces, their labels and the positions of their vertices is looked at.
/// Parallel; the patches depend on the mesh alone. Once `cancellation` is requested it ends
/// soon, and what it returns means nothing.
///
/// The lattice bevels a sharp edge in triangles of any direction, about a spacing wide. So a
/// patch begins with calm faces: every face within two rings around one looks at most
/// `angle_deg` from its direction. Calm faces beside each other are one patch. It grows a ring
/// further over faces that are calm within one ring; those of them that no patch reached are
/// patches, too, as the rim of a plate. The rest goes, ring by ring, to the patch beside it
/// whose face looks most in its own direction. Patches are one again where nine tenths of the
/// border between them turn by no more than a quarter of the angle: there was a narrow neck,
/// and no crease. What touches no patch, as a piece of the surface a few triangles wide, is in
/// none.
CreasePatches find_crease_patches(const TetMesh& surface,
                                  std::uint16_t label,
                                  double angle_deg,
                                  const Cancellation& cancellation = {});

}  // namespace tet
