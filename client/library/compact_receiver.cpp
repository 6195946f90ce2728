#include "client/library/compact_receiver.h"

#include <utility>

#include "client/library/stream_checks.h"
#include "core/base/parallel.h"
#include "core/transfer/compact_mesh.h"
#include "proto/convert/mesh_header.h"
#include "proto/convert/mesh_parts.h"

namespace tet {

struct CompactReceiver::Parts {
  CompactFrame frame;
  CompactBricks bricks;
};

CompactReceiver::CompactReceiver(std::unique_ptr<Parts> parts) noexcept
    : parts_(std::move(parts)) {}
CompactReceiver::~CompactReceiver() = default;
CompactReceiver::CompactReceiver(CompactReceiver&&) noexcept = default;
CompactReceiver& CompactReceiver::operator=(CompactReceiver&&) noexcept = default;

absl::StatusOr<CompactReceiver> CompactReceiver::begin(const v1::MeshHeader& header) {
  const auto preset = from_proto(header.canonical_request().preset());
  const auto lattice = from_proto(header.lattice());
  const bool fits = preset && lattice.ok() && header.fields().empty() &&
                    header.has_regions() == stuffing_rules(*preset).both_sides;
  if (!fits) return bad_stream("a header without lattice");
  const CompactFrame frame{*lattice, stuffing_rules(*preset)};
  return CompactReceiver(
      std::make_unique<Parts>(Parts{frame, CompactBricks(frame.rules.both_sides)}));
}

absl::Status CompactReceiver::add(std::span<const std::byte> chunk) {
  return parts_->bricks.add(chunk);
}

absl::StatusOr<FilledMesh> CompactReceiver::finish(const MeshHeader& header,
                                                   const Cancellation& cancellation,
                                                   TetMesh used,
                                                   Statistics statistics) && {
  TaskPool pool;
  absl::StatusOr<FilledMesh> filled = absl::InternalError("not made");
  pool.run([&] {
    filled = decode_mesh(std::move(parts_->bricks), header, parts_->frame, cancellation,
                         std::move(used), statistics);
  });
  return filled;
}

}  // namespace tet
