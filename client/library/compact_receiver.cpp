#include "client/library/compact_receiver.h"

#include <cmath>
#include <utility>

#include "client/library/stream_checks.h"
#include "core/base/parallel.h"
#include "core/transfer/compact_mesh.h"
#include "core/volume/check_transform.h"
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

namespace {

/// Whether a server makes such a lattice: one of cubes, which the header's spacing is the edge
/// of. Positions on any other may be no numbers.
bool may_be_lattice(const LatticeToWorld& lattice, double spacing) {
  constexpr double kRounding = 1e-3;  // what counts as a cube is off by 1e-4
  VoxelTransform transform{lattice.linear, {}, 1};
  transform.voxel_size = voxel_edge(transform);
  return check_transform(transform).ok() &&
         std::abs(transform.voxel_size - spacing) <= kRounding * spacing;
}

}  // namespace

absl::StatusOr<CompactReceiver> CompactReceiver::begin(const v1::MeshHeader& header) {
  const auto preset = from_proto(header.canonical_request().preset());
  const auto lattice = from_proto(header.lattice());
  const bool fits = preset && lattice.ok() && header.fields().empty() &&
                    header.has_regions() == stuffing_rules(*preset).both_sides;
  if (!fits) return bad_stream("a header without lattice");
  if (!may_be_lattice(*lattice, header.spacing())) {
    return bad_stream("a lattice that no mesh is made on");
  }
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
