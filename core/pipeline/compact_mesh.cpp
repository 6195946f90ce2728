#include "core/pipeline/compact_mesh.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <utility>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "core/base/parallel.h"
#include "core/pipeline/fill_brick.h"
#include "core/stuffing/cut_tet.h"

namespace tet {
namespace {

constexpr std::size_t kBricksPerRange = 16;

/// Whether every surface quad that has a vertex in its middle is said to have one.
bool fans_are_right(const CountedMesh& mesh) {
  if (!mesh.rules().both_sides) return true;
  const OctreeLevel& finest = mesh.tree().levels[0];
  std::atomic<bool> right{true};
  for_each_range(finest.bricks.size(), kBricksPerRange, [&](std::size_t begin, std::size_t end) {
    const auto lattice = std::make_unique<StuffedLattice>();
    for (std::size_t i = begin; i < end; ++i) {
      if (!mesh.touches_surface(i)) continue;
      mesh.unpack_lattice(i, *lattice);
      const HaloSet leaf = gather_halo(finest, finest.leaf, finest.bricks[i]);
      const FanMasks fans =
          find_fans(*lattice, gather_nodes(mesh.neighbourhood(i), leaf), mesh.rules());
      if (fans != mesh.survey().fans[mesh.stuffed(i)]) right = false;
    }
  });
  return right;
}

absl::Status check_totals(const CountedMesh& mesh, const MeshHeader& header) {
  const std::uint64_t vertices = mesh.first_vertex(mesh.brick_count());
  const std::uint64_t tets = mesh.first_tet(mesh.brick_count());
  if (vertices != header.vertex_count || tets != header.tet_count) {
    return absl::DataLossError(absl::StrFormat(
        "the compact chunks make %d vertices and %d tets; the header says %d and %d", vertices,
        tets, header.vertex_count, header.tet_count));
  }
  if (!fans_are_right(mesh)) {
    return absl::DataLossError("a compact chunk is broken: a fan where there is none");
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<TetMesh> decode_mesh(CompactBricks bricks,
                                    const MeshHeader& header,
                                    const CompactFrame& frame,
                                    const Cancellation& cancellation) {
  const absl::StatusOr<CountedMesh> counted = std::move(bricks).count(frame.rules);
  if (!counted.ok()) return counted.status();
  if (auto status = check_totals(*counted, header); !status.ok()) return status;
  TetMesh mesh;
  try {
    mesh = TetMesh(header);
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError(absl::StrFormat(
        "no memory for %d vertices and %d tets", header.vertex_count, header.tet_count));
  }
  const Volume no_samples;  // all that they decided has come with the chunks
  PhiField field;
  field.volume = &no_samples;
  const std::size_t count = counted->brick_count();
  for_each_range(count, kBricksPerRange, [&](std::size_t begin, std::size_t end) {
    MeshWorkspace workspace;
    BrickFiller filler(*counted, field, header, frame.to_world, workspace.impl());
    for (std::size_t i = begin; i < end && !cancellation.requested(); ++i) {
      const std::uint64_t vertex = counted->first_vertex(i), tet = counted->first_tet(i);
      filler.fill(i, mesh.columns_of({vertex, counted->first_vertex(i + 1) - vertex, tet,
                                      counted->first_tet(i + 1) - tet}));
    }
  });
  if (absl::Status status = check_cancelled(cancellation); !status.ok()) return status;
  return mesh;
}

}  // namespace tet
