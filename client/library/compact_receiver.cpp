#include "client/library/compact_receiver.h"

#include <utility>

#include "client/library/stream_checks.h"
#include "core/base/parallel.h"
#include "proto/convert/mesh_header.h"
#include "proto/convert/mesh_parts.h"

namespace tet {
absl::StatusOr<CompactReceiver> CompactReceiver::begin(const v1::MeshHeader& header) {
  const auto preset = from_proto(header.canonical_request().preset());
  const auto lattice = from_proto(header.lattice());
  const bool fits = preset && lattice.ok() && header.fields().empty() &&
                    header.has_regions() == stuffing_rules(*preset).both_sides;
  if (!fits) return bad_stream("a header without lattice");
  return CompactReceiver({*lattice, stuffing_rules(*preset)});
}

absl::StatusOr<FilledMesh> CompactReceiver::finish(const MeshHeader& header,
                                                   const Cancellation& cancellation,
                                                   TetMesh used,
                                                   Statistics statistics) && {
  TaskPool pool;
  absl::StatusOr<FilledMesh> filled = absl::InternalError("not made");
  pool.run([&] {
    filled = decode_mesh(std::move(bricks_), header, frame_, cancellation, std::move(used),
                         statistics);
  });
  return filled;
}

}  // namespace tet
