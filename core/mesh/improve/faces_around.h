// What lies beyond the tets around a vertex.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/mix_bits.h"
#include "core/mesh/faces.h"
#include "core/mesh/improve/vertex_stars.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// What the faces around a vertex say, by XOR of their hashes as seen from each tet: those
/// seen twice cancel, so zero means that all are, but for an accident once in 2^64.
struct FacesAroundVertex {
  std::uint64_t all = 0;
  std::uint64_t outside = 0;  ///< of the outside region's tets alone

  bool on_boundary() const noexcept { return all != 0; }
  bool between_regions() const noexcept { return outside != 0; }
};

inline FacesAroundVertex faces_around(const TetMesh& mesh,
                                      std::span<const TetCorner> star) noexcept {
  FacesAroundVertex faces;
  for (const TetCorner corner : star) {
    const Triangle link = face_of(mesh.tet(corner.tet()), corner.corner());
    const std::uint64_t a = mix_bits(link[0]), b = mix_bits(link[1]), c = mix_bits(link[2]);
    const std::uint64_t hash = mix_bits(a + b) ^ mix_bits(b + c) ^ mix_bits(c + a);
    faces.all ^= hash;
    if (mesh.region(corner.tet()) == MeshRegion::kOutside) faces.outside ^= hash;
  }
  return faces;
}

}  // namespace tet
