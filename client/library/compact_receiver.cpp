#include "client/library/compact_receiver.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <absl/status/status.h>

#include "core/base/parallel.h"

namespace tet {
namespace {

std::optional<Preset> to_core(v1::Preset preset) {
  switch (preset) {
    case v1::PRESET_DEFAULT:
      return Preset::kDefault;
    case v1::PRESET_MIN_ANGLE:
      return Preset::kMinAngle;
    case v1::PRESET_BOTH_SIDES:
      return Preset::kBothSides;
    default:
      return std::nullopt;
  }
}

bool is_valid(const v1::Lattice& lattice) {
  return lattice.linear_size() == 9 &&
         std::ranges::all_of(lattice.linear(), [](double v) { return std::isfinite(v); });
}

LatticeToWorld to_core(const v1::Lattice& lattice) {
  VoxelTransform transform;
  for (int i = 0; i < 9; ++i) {
    const auto row = static_cast<std::size_t>(i / 3), column = static_cast<std::size_t>(i % 3);
    transform.linear[row][column] = lattice.linear(i);
  }
  return {transform.linear,
          {lattice.origin_x(), lattice.origin_y(), lattice.origin_z()},
          transform.mirrors()};
}

}  // namespace

absl::StatusOr<CompactReceiver> CompactReceiver::begin(const v1::MeshHeader& header) {
  const auto preset = to_core(header.canonical_request().preset());
  const bool fits = preset && is_valid(header.lattice()) && header.fields().empty() &&
                    header.has_regions() == stuffing_rules(*preset).both_sides;
  if (!fits)
    return absl::DataLossError("the server's stream is broken: a header without lattice");
  return CompactReceiver({to_core(header.lattice()), stuffing_rules(*preset)});
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
