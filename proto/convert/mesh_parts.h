// What a header has beside a mesh's totals, as messages, and back: what is kept of an earlier
// mesh, and where the lattice of a compact one lies.
#pragma once

#include <absl/status/statusor.h>

#include "core/mesh/lattice_to_world.h"
#include "core/mesh/stable/splice.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

void to_proto(const KeptParts& kept, v1::KeptParts& message);
void to_proto(const LatticeToWorld& to_world, v1::Lattice& message);

// The messages are not trusted. Errors: kInvalidArgument, which begins with the field.

/// Whether the runs fit two meshes is for splice_mesh to see.
absl::StatusOr<KeptParts> from_proto(const v1::KeptParts& message);

/// Takes nine finite numbers; they may describe a lattice that is flat.
absl::StatusOr<LatticeToWorld> from_proto(const v1::Lattice& message);

}  // namespace tet
