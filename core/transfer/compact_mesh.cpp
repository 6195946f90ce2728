#include "core/transfer/compact_mesh.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <utility>
#include <vector>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "core/base/parallel.h"
#include "core/base/scratch_pool.h"
#include "core/lattice/reach.h"
#include "core/mesh/find_faces.h"
#include "core/plan/brick/fill_brick.h"
#include "core/plan/mesh_workspace.h"
#include "core/stuffing/brick_geometry.h"
#include "core/stuffing/cut_tet.h"

namespace tet {
namespace {

constexpr std::size_t kCodedPerRange = 16;

/// Enters the cut points that a finest brick's tets reach.
void unpack_cut_points(const CountedMesh& mesh, std::size_t brick, StuffedLattice& lattice) {
  lattice.warped.cut = {};
  const VerticesAround around = mesh.vertices_around(brick);
  for (std::size_t o = 0; o < around.size(); ++o) {
    if (!around[o].at_surface) continue;
    const PackedGeometry geometry(around[o].geometry, *around[o].stuffed);
    std::size_t first = geometry.zeros();
    for (std::size_t family = 0; family < kEdgeFamilies; ++family) {
      first += for_each_in_reach(
          around[o].stuffed->cut[family], o, [&](int x, int y, int z, std::uint32_t rank) {
            const int low = halo_index(x, y, z);
            lattice.warped.cut[family].set(low);
            lattice.cuts.fraction[family][static_cast<std::size_t>(low)] =
                geometry.fraction(first + rank);
          });
    }
  }
}

/// Whether `fits(shape, signs)` is true for every tet shape of which some tets are cut.
template <class Fits>
bool all_cuts_fit(const FinestNodes& nodes, const Fits& fits) {
  for (int axis = 0; axis < 3; ++axis) {
    const FaceSigns faces = signs_around_faces(nodes, axis);
    for (std::size_t turn = 0; turn < 4; ++turn) {
      const TetShape& shape = kTetShape[static_cast<std::size_t>(axis) * 4 + turn];
      const ShapeSigns signs = signs_of_shape(faces, shape);
      if (signs.cut.any() && !fits(shape, signs)) return false;
    }
  }
  return true;
}

bool has_cut_tets(const FinestNodes& nodes) {
  return !all_cuts_fit(nodes, [](const TetShape&, const ShapeSigns&) { return false; });
}

/// Whether a brick's tets are cut only where cut points have come.
bool cuts_have_points(const FinestNodes& nodes, const StuffedLattice& lattice) {
  return all_cuts_fit(nodes, [&](const TetShape& shape, const ShapeSigns& signs) {
    for (std::size_t e = 0; e < kTetEdge.size(); ++e) {
      const auto [a, b] = kTetEdge[e];
      const HaloSet crossed = signs.cut & ((*signs.plus[a] - *signs.plus[b] - *signs.zero[b]) |
                                           (*signs.plus[b] - *signs.plus[a] - *signs.zero[a]));
      const HaloSet there =
          seen_from(lattice.warped.cut[shape.edge_family[e]], shape.offset[a]);
      if ((crossed - there).any()) return false;
    }
    return true;
  });
}

/// Looks at what the chunks leave out: signs say which tets are cut, and whoever fills them
/// takes for granted that their cut points, and the middles of their quads, are there.
class CutChecker {
 public:
  explicit CutChecker(const CountedMesh& mesh)
      : mesh_(mesh),
        finest_(mesh.tree().levels[0]),
        lattice_(std::make_unique<StuffedLattice>()) {}

  /// Whether a finest brick has all that its signs ask for, and no more.
  bool fits(std::size_t brick) {
    const VerticesAround around = mesh_.vertices_around(brick);
    const bool both_sides = mesh_.rules().both_sides;
    if (!around[0].at_surface) {
      // Far from the surface all around are alike.
      const auto alike = [&](const OwnedVertices& other) {
        return other.stuffed == around[0].stuffed;
      };
      return std::ranges::all_of(around, alike) || !has_cut_tets(nodes_of(brick));
    }
    const bool complete = std::ranges::all_of(around, &OwnedVertices::at_surface);
    if (complete && !both_sides) return true;
    unpack_cut_points(mesh_, brick, *lattice_);
    const FinestNodes nodes = nodes_of(brick);
    if (!complete && !cuts_have_points(nodes, *lattice_)) return false;
    return !both_sides || find_fans(*lattice_, nodes, mesh_.rules()) == *around[0].fans;
  }

 private:
  FinestNodes nodes_of(std::size_t brick) const {
    return gather_nodes(mesh_.neighbourhood(brick),
                        gather_halo(finest_, finest_.leaf, finest_.bricks[brick]));
  }

  const CountedMesh& mesh_;
  const OctreeLevel& finest_;
  std::unique_ptr<StuffedLattice> lattice_;
};

absl::Status check_cuts(const CountedMesh& mesh, const Cancellation& cancellation) {
  std::atomic<bool> fits{true};
  for_each_range(mesh.tree().levels[0].bricks.size(), kCodedPerRange,
                 [&](std::size_t begin, std::size_t end) {
                   CutChecker checker(mesh);
                   for (std::size_t i = begin; i < end && !cancellation.requested(); ++i) {
                     if (!checker.fits(i)) fits = false;
                   }
                 });
  // Nothing may be filled that was not looked at.
  if (absl::Status status = check_cancelled(cancellation); !status.ok()) return status;
  if (fits) return absl::OkStatus();
  return absl::DataLossError(
      "a compact chunk is broken: a tet is cut where no cut point is, or has a fan where none "
      "is");
}

absl::Status check_totals(const CountedMesh& mesh, const MeshHeader& header) {
  const std::uint64_t vertices = mesh.first_vertex(mesh.brick_count());
  const std::uint64_t tets = mesh.first_tet(mesh.brick_count());
  const std::uint64_t faces = mesh.first_face(mesh.brick_count());
  if (vertices != header.vertex_count || tets != header.tet_count ||
      faces != header.face_count) {
    return absl::DataLossError(absl::StrFormat(
        "the compact chunks make %d vertices, %d tets and %d faces; the header says %d, %d and "
        "%d",
        vertices, tets, faces, header.vertex_count, header.tet_count, header.face_count));
  }
  // The filler gives faces these labels, whatever else the header has.
  MeshHeader labelled;
  labelled.face_labels = face_labels_of(mesh.rules().both_sides, mesh.rules().both_sides);
  add_region_labels(header.face_regions, labelled);
  if (header.has_faces() && labelled.face_labels.size() != header.face_labels.size()) {
    return absl::DataLossError(
        absl::StrFormat("faces of compact chunks have %d labels; the header says %d",
                        labelled.face_labels.size(), header.face_labels.size()));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<FilledMesh> decode_mesh(CompactBricks bricks,
                                       const MeshHeader& header,
                                       const CompactFrame& frame,
                                       const Cancellation& cancellation,
                                       TetMesh used,
                                       Statistics statistics) {
  const std::vector<std::size_t> first_brick = bricks.first_brick();
  absl::StatusOr<CountedMesh> counted =
      std::move(bricks).count(frame.rules, header.has_faces());
  if (!counted.ok()) return counted.status();
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  if (auto status = check_totals(*counted, header); !status.ok()) return status;
  if (auto status = check_cuts(*counted, cancellation); !status.ok()) return status;
  FilledMesh filled;
  try {
    filled.mesh = TetMesh(header, std::move(used));
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError(absl::StrFormat("no memory for %d vertices and %d tets",
                                                        header.vertex_count, header.tet_count));
  }
  const Volume no_samples;  // all that they decided has come with the chunks
  PhiField field;
  field.volume = &no_samples;
  std::vector<QualityStats> stats(first_brick.size() - 1);
  std::atomic<bool> whole{true};  // what another's octree lacks has ids of no vertex
  ScratchPool<MeshWorkspace> workspaces;
  for_each_range(stats.size(), 1, [&](std::size_t begin, std::size_t end) {
    const ScratchPool<MeshWorkspace>::Turn workspace(workspaces);
    for (std::size_t chunk = begin; chunk < end && !cancellation.requested(); ++chunk) {
      BrickFiller filler(*counted, field, header, frame.to_world, statistics,
                         workspace->get<BrickScratch>());
      for (std::size_t i = first_brick[chunk]; i < first_brick[chunk + 1]; ++i) {
        const ChunkColumns columns = filled.mesh.columns_of(counted->extent({i, i + 1}));
        filler.fill(i, columns);
        if (!ids_are_within(columns.tets, header)) whole = false;
      }
      stats[chunk] = filler.stats();
    }
  });
  if (absl::Status status = check_cancelled(cancellation); !status.ok()) return status;
  if (!whole) return absl::DataLossError("a compact chunk is broken: its leaves leave gaps");
  for (const QualityStats& chunk : stats) filled.quality.add(chunk);
  return filled;
}

}  // namespace tet
