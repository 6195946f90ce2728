// A mesh made from an earlier one, of which it keeps parts.
#pragma once

#include <cstdint>
#include <vector>

#include <absl/status/statusor.h>

#include "core/mesh/tet_mesh.h"

namespace tet {

/// `count` vertices or tets that two meshes have in common: number `from` on in the earlier
/// mesh, number `to` on in the new one.
struct KeptRun {
  std::uint64_t from = 0, to = 0, count = 0;
  friend bool operator==(const KeptRun&, const KeptRun&) = default;
};

/// What a mesh keeps of an earlier one; runs are sorted and do not overlap, in either mesh.
///
/// A kept vertex lies where it lay. A kept tet has the same vertices, all of them kept, under
/// their new ids. So every part of a mesh is named by its run, and ids shift with the runs.
struct KeptParts {
  std::vector<KeptRun> vertices, tets;
  /// Chunks bring what is not kept and nothing else, in the order of numbers, so that there may
  /// be kept parts within one; they number what is not kept. Else a chunk is a run of the mesh.
  bool loose = false;
};

/// Whether parts of a mesh can be kept at all: both are stored alike, about the same origin,
/// and `to` has no fields, whose values may change where nothing else does.
bool can_splice(const MeshHeader& from, const MeshHeader& to) noexcept;

/// Whether a mesh of `to` can keep these parts of one of `from`. Errors: kInvalidArgument
/// (headers that cannot be spliced, runs that are out of order or do not fit the meshes).
absl::Status check_splice(const MeshHeader& from, const MeshHeader& to, const KeptParts& kept);

/// A mesh with the kept parts of `from` in their new places; its other vertices and tets are
/// unspecified, to be written through `columns_of`. Made in the memory of `used`, a mesh that
/// is no longer needed, as far as that is enough. Parallel; run it on a TaskPool.
///
/// Errors: kInvalidArgument (headers that cannot be spliced, runs that are out of order or do
/// not fit the meshes, a kept tet with a vertex that is not kept), kResourceExhausted (no
/// memory).
absl::StatusOr<TetMesh> splice_mesh(const TetMesh& from,
                                    const MeshHeader& header,
                                    const KeptParts& kept,
                                    TetMesh used = {});

}  // namespace tet
