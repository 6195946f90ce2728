#include "core/mesh/stable/splice.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstring>
#include <new>
#include <span>
#include <utility>
#include <vector>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "core/base/parallel.h"
#include "core/mesh/stable/move_ids.h"

namespace tet {
namespace {

constexpr std::size_t kBlocksPerRange = 512;

absl::Status check_runs(const std::vector<KeptRun>& runs,
                        const char* what,
                        std::uint64_t from_count,
                        std::uint64_t to_count) {
  std::uint64_t from = 0, to = 0;
  for (const KeptRun& run : runs) {
    const bool fits = run.from >= from && run.to >= to && run.from <= from_count &&
                      run.to <= to_count && run.count <= from_count - run.from &&
                      run.count <= to_count - run.to;
    if (!fits) {
      return absl::InvalidArgumentError(
          absl::StrFormat("%d kept %s from %d to %d do not fit meshes of %d and %d, or overlap",
                          run.count, what, run.from, run.to, from_count, to_count));
    }
    from = run.from + run.count;
    to = run.to + run.count;
  }
  return absl::OkStatus();
}

template <class Index>
bool move_tets(const TetMesh& from, const NewIds& ids, const KeptRun& run, TetMesh& to) {
  const auto* const source = reinterpret_cast<const Index*>(from.tets.bytes().data());
  auto* const target = reinterpret_cast<Index*>(to.tets.bytes().data());
  const std::size_t blocks = (run.count + kBlockTets - 1) / kBlockTets;
  std::atomic<bool> all_kept{true};
  for_each_range(blocks, kBlocksPerRange, [&](std::size_t begin, std::size_t end) {
    IdMover<Index> mover(ids);
    for (std::size_t block = begin; block < end; ++block) {
      const std::uint64_t first = block * kBlockTets;
      const std::uint64_t count = std::min(kBlockTets, run.count - first);
      const std::span block_ids(source + 4 * (run.from + first), 4 * count);
      if (!mover.move(block_ids, target + 4 * (run.to + first))) all_kept = false;
    }
  });
  return all_kept;
}

void copy_rows(std::span<const std::byte> from,
               std::span<std::byte> to,
               std::size_t row_bytes,
               const KeptRun& run) {
  if (run.count == 0) return;
  std::memcpy(to.data() + run.to * row_bytes, from.data() + run.from * row_bytes,
              run.count * row_bytes);
}

}  // namespace

bool can_splice(const MeshHeader& from, const MeshHeader& to) noexcept {
  return from.coordinate_type == to.coordinate_type && from.index_type == to.index_type &&
         from.has_regions == to.has_regions && from.origin == to.origin &&
         from.spacing == to.spacing && to.fields.empty() && !to.has_faces() &&
         to.labels.empty();
}

absl::Status check_splice(const MeshHeader& from, const MeshHeader& to, const KeptParts& kept) {
  if (!can_splice(from, to)) {
    return absl::InvalidArgumentError(
        "meshes with other types, about another origin, with fields, faces or labels have no "
        "parts in common");
  }
  absl::Status status =
      check_runs(kept.vertices, "vertices", from.vertex_count, to.vertex_count);
  if (status.ok()) status = check_runs(kept.tets, "tets", from.tet_count, to.tet_count);
  return status;
}

absl::StatusOr<TetMesh> splice_mesh(const TetMesh& from,
                                    const MeshHeader& header,
                                    const KeptParts& kept,
                                    TetMesh used) {
  if (absl::Status status = check_splice(from.header, header, kept); !status.ok())
    return status;
  TetMesh mesh;
  try {
    mesh = TetMesh(header, std::move(used));
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError(absl::StrFormat("no memory for %d vertices and %d tets",
                                                        header.vertex_count, header.tet_count));
  }
  for_each_index(kept.vertices.size(), [&](std::size_t i) {
    copy_rows(from.positions.bytes(), mesh.positions.bytes(),
              3 * size_of(header.coordinate_type), kept.vertices[i]);
  });
  const NewIds ids(kept.vertices, from.header.vertex_count);
  for (const KeptRun& run : kept.tets) {
    if (header.has_regions) copy_rows(from.regions.bytes(), mesh.regions.bytes(), 1, run);
    const bool moved = header.index_type == IndexType::kUint32
                           ? move_tets<std::uint32_t>(from, ids, run, mesh)
                           : move_tets<std::uint64_t>(from, ids, run, mesh);
    if (!moved) {
      return absl::InvalidArgumentError("a kept tet has a vertex that is not kept");
    }
  }
  return mesh;
}

}  // namespace tet
