#include "core/mesh/splice.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstring>
#include <new>
#include <span>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "core/base/parallel.h"

namespace tet {
namespace {

/// Tets that are moved at a time: few enough to stay in the cache between two looks at them.
constexpr std::uint64_t kBlockTets = 1024;

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

/// New ids of kept vertices. Tets in a row use vertices of few runs, so the last one is tried
/// first.
class NewIds {
 public:
  explicit NewIds(std::span<const KeptRun> runs) : runs_(runs) {}

  /// The run that holds every id in [least, most], or null.
  const KeptRun* run_of(std::uint64_t least, std::uint64_t most) {
    if (!holds(last_, least)) last_ = find(least);
    return holds(last_, least) && holds(last_, most) ? last_ : nullptr;
  }

 private:
  static bool holds(const KeptRun* run, std::uint64_t id) {
    return run != nullptr && id >= run->from && id - run->from < run->count;
  }
  const KeptRun* find(std::uint64_t id) const {
    const auto after = std::upper_bound(
        runs_.begin(), runs_.end(), id,
        [](std::uint64_t value, const KeptRun& run) { return value < run.from; });
    return after == runs_.begin() ? nullptr : &*(after - 1);
  }

  std::span<const KeptRun> runs_;
  const KeptRun* last_ = nullptr;
};

/// Writes ids under their new numbers; false where one is not kept.
template <class Index>
bool move_ids(std::span<const Index> from, NewIds& ids, Index* to) {
  const auto [least, most] = std::ranges::minmax(from);
  if (const KeptRun* run = ids.run_of(least, most)) {
    const auto shift = static_cast<Index>(run->to - run->from);  // modulo 2^n, so down too
    std::ranges::transform(from, to, [&](Index id) { return static_cast<Index>(id + shift); });
    return true;
  }
  for (const Index id : from) {
    const KeptRun* run = ids.run_of(id, id);
    if (run == nullptr) return false;
    *to++ = static_cast<Index>(id + (run->to - run->from));
  }
  return true;
}

template <class Index>
bool move_tets(const TetMesh& from, const KeptParts& kept, const KeptRun& run, TetMesh& to) {
  const auto* const source = reinterpret_cast<const Index*>(from.tets.bytes().data());
  auto* const target = reinterpret_cast<Index*>(to.tets.bytes().data());
  const std::size_t blocks = (run.count + kBlockTets - 1) / kBlockTets;
  std::atomic<bool> all_kept{true};
  for_each_range(blocks, 16, [&](std::size_t begin, std::size_t end) {
    NewIds ids(kept.vertices);
    for (std::size_t block = begin; block < end; ++block) {
      const std::uint64_t first = block * kBlockTets;
      const std::uint64_t count = std::min(kBlockTets, run.count - first);
      const std::span block_ids(source + 4 * (run.from + first), 4 * count);
      if (!move_ids(block_ids, ids, target + 4 * (run.to + first))) all_kept = false;
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

absl::Status check_splice(const MeshHeader& from, const MeshHeader& to, const KeptParts& kept) {
  if (!can_splice(from, to)) {
    return absl::InvalidArgumentError(
        "meshes with other types, about another origin or with fields have no parts in "
        "common");
  }
  absl::Status status =
      check_runs(kept.vertices, "vertices", from.vertex_count, to.vertex_count);
  if (status.ok()) status = check_runs(kept.tets, "tets", from.tet_count, to.tet_count);
  return status;
}

}  // namespace

bool can_splice(const MeshHeader& from, const MeshHeader& to) noexcept {
  return from.coordinate_type == to.coordinate_type && from.index_type == to.index_type &&
         from.has_regions == to.has_regions && from.origin == to.origin &&
         from.spacing == to.spacing && to.fields.empty();
}

absl::StatusOr<TetMesh> splice_mesh(const TetMesh& from,
                                    const MeshHeader& header,
                                    const KeptParts& kept) {
  if (absl::Status status = check_splice(from.header, header, kept); !status.ok())
    return status;
  TetMesh mesh;
  try {
    mesh = TetMesh(header);
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError(absl::StrFormat("no memory for %d vertices and %d tets",
                                                        header.vertex_count, header.tet_count));
  }
  for_each_index(kept.vertices.size(), [&](std::size_t i) {
    copy_rows(from.positions.bytes(), mesh.positions.bytes(),
              3 * size_of(header.coordinate_type), kept.vertices[i]);
  });
  for (const KeptRun& run : kept.tets) {
    if (header.has_regions) copy_rows(from.regions.bytes(), mesh.regions.bytes(), 1, run);
    const bool moved = header.index_type == IndexType::kUint32
                           ? move_tets<std::uint32_t>(from, kept, run, mesh)
                           : move_tets<std::uint64_t>(from, kept, run, mesh);
    if (!moved) {
      return absl::InvalidArgumentError("a kept tet has a vertex that is not kept");
    }
  }
  return mesh;
}

}  // namespace tet
