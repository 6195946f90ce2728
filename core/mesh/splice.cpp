#include "core/mesh/splice.h"

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

/// New ids of kept vertices: what is to be added to the old ones. Immutable.
class NewIds {
 public:
  NewIds(std::span<const KeptRun> runs, std::uint64_t from_count)
      : runs_(runs),
        from_count_(from_count),
        shifts_((from_count + kSlot - 1) / kSlot, kMixed) {
    for (const KeptRun& run : runs) {
      const std::uint64_t first = (run.from + kSlot - 1) / kSlot;
      const std::uint64_t end =
          run.from + run.count == from_count ? shifts_.size() : (run.from + run.count) / kSlot;
      for (std::uint64_t slot = first; slot < end; ++slot) shifts_[slot] = run.to - run.from;
    }
  }

  /// The run that holds every id in [least, most], or null.
  const KeptRun* run_of(std::uint64_t least, std::uint64_t most) const {
    const auto after = std::upper_bound(
        runs_.begin(), runs_.end(), least,
        [](std::uint64_t value, const KeptRun& run) { return value < run.from; });
    if (after == runs_.begin()) return nullptr;
    const KeptRun* const run = &*(after - 1);
    return most - run->from < run->count ? run : nullptr;
  }

  /// Writes ids of the earlier mesh, each below `from_count`; false where one is not kept.
  template <class Index>
  bool move(std::span<const Index> from, Index* to) const {
    for (const Index id : from) {
      std::uint64_t shift = shifts_[id / kSlot];
      if (shift == kMixed) {
        const KeptRun* const run = run_of(id, id);
        if (run == nullptr) return false;
        shift = run->to - run->from;
      }
      *to++ = static_cast<Index>(id + shift);  // modulo 2^n, so down too
    }
    return true;
  }

  std::uint64_t from_count() const { return from_count_; }

 private:
  /// Ids in a row that are looked up together where one run holds all of them.
  static constexpr std::uint64_t kSlot = 256;
  static constexpr std::uint64_t kMixed = std::uint64_t{1} << 63;  // no shift: ids are smaller

  std::span<const KeptRun> runs_;
  std::uint64_t from_count_;
  std::vector<std::uint64_t> shifts_;  // of each slot
};

template <class Index>
struct IdRange {
  Index least, most;
};

/// Of at least one id.
template <class Index>
IdRange<Index> range_of(std::span<const Index> ids) {
  IdRange<Index> range{ids[0], ids[0]};
  for (const Index id : ids) {  // vectorised, as std::ranges::minmax is not
    range.least = id < range.least ? id : range.least;
    range.most = id > range.most ? id : range.most;
  }
  return range;
}

/// Writes ids under their new numbers; false where one is not kept.
template <class Index>
bool move_ids(std::span<const Index> from, const NewIds& ids, Index* to) {
  const auto [least, most] = range_of(from);
  if (most >= ids.from_count()) return false;
  const KeptRun* const run = ids.run_of(least, most);
  if (run == nullptr) return ids.move(from, to);
  const auto shift = static_cast<Index>(run->to - run->from);
  for (std::size_t i = 0; i < from.size(); ++i) to[i] = static_cast<Index>(from[i] + shift);
  return true;
}

template <class Index>
bool move_tets(const TetMesh& from, const NewIds& ids, const KeptRun& run, TetMesh& to) {
  const auto* const source = reinterpret_cast<const Index*>(from.tets.bytes().data());
  auto* const target = reinterpret_cast<Index*>(to.tets.bytes().data());
  const std::size_t blocks = (run.count + kBlockTets - 1) / kBlockTets;
  std::atomic<bool> all_kept{true};
  for_each_range(blocks, 16, [&](std::size_t begin, std::size_t end) {
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
