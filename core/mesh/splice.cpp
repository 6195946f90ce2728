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

/// Tets that are moved at a time: so few that most have ids of a run or two, and that they are
/// still in the nearest cache when they are looked at again.
constexpr std::uint64_t kBlockTets = 32;
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

bool holds(const KeptRun& run, std::uint64_t id) noexcept {
  return id >= run.from && id - run.from < run.count;
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

  /// The run that holds an id, or null.
  const KeptRun* run_of(std::uint64_t id) const {
    const auto after = std::upper_bound(
        runs_.begin(), runs_.end(), id,
        [](std::uint64_t value, const KeptRun& run) { return value < run.from; });
    if (after == runs_.begin()) return nullptr;
    const KeptRun* const run = &*(after - 1);
    return holds(*run, id) ? run : nullptr;
  }

  /// Writes ids of the earlier mesh, each below `from_count`; false where one is not kept.
  template <class Index>
  bool move(std::span<const Index> from, Index* to) const {
    for (const Index id : from) {
      std::uint64_t shift = shifts_[id / kSlot];
      if (shift == kMixed) {
        const KeptRun* const run = run_of(id);
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

/// Finds the least and the most of at least one id.
template <class Index>
IdRange<Index> range_of(std::span<const Index> ids) {
  IdRange<Index> range{ids[0], ids[0]};
  for (const Index id : ids) {  // vectorised, as std::ranges::minmax is not
    range.least = id < range.least ? id : range.least;
    range.most = id > range.most ? id : range.most;
  }
  return range;
}

/// Writes the ids of block after block under their new numbers. Most blocks have ids of one run
/// or of two, and the next block those of the same: only for others each id is looked up.
template <class Index>
class IdMover {
 public:
  explicit IdMover(const NewIds& ids) : ids_(ids) {}

  /// False where one is not kept.
  bool move(std::span<const Index> from, Index* to) {
    const auto [least, most] = range_of(from);
    if (most >= ids_.from_count()) return false;
    if (!enter(least, low_) || !enter(most, high_)) return false;
    if (low_ == high_) {
      add(from, shift_of(*low_), to);
      return true;
    }
    return add_either(from, to) || ids_.move(from, to);
  }

 private:
  static Index shift_of(const KeptRun& run) { return static_cast<Index>(run.to - run.from); }

  /// Makes `run` the one that holds an id.
  bool enter(Index id, const KeptRun*& run) const {
    if (run == nullptr || !holds(*run, id)) run = ids_.run_of(id);
    return run != nullptr;
  }

  static void add(std::span<const Index> from, Index shift, Index* to) {
    for (std::size_t i = 0; i < from.size(); ++i) to[i] = static_cast<Index>(from[i] + shift);
  }

  /// False where some id is in neither run.
  bool add_either(std::span<const Index> from, Index* to) const {
    const auto low_end = static_cast<Index>(low_->from + low_->count);
    const auto high_begin = static_cast<Index>(high_->from);
    const Index low_shift = shift_of(*low_), high_shift = shift_of(*high_);
    Index between = 0;
    for (std::size_t i = 0; i < from.size(); ++i) {
      const Index id = from[i];
      const bool is_high = id >= high_begin;
      between |= static_cast<Index>(id >= low_end) & static_cast<Index>(!is_high);
      to[i] = static_cast<Index>(id + (is_high ? high_shift : low_shift));
    }
    return between == 0;
  }

  const NewIds& ids_;
  const KeptRun *low_ = nullptr, *high_ = nullptr;  // of the block before
};

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

}  // namespace

bool can_splice(const MeshHeader& from, const MeshHeader& to) noexcept {
  return from.coordinate_type == to.coordinate_type && from.index_type == to.index_type &&
         from.has_regions == to.has_regions && from.origin == to.origin &&
         from.spacing == to.spacing && to.fields.empty() && !to.has_faces() &&
         to.labels.empty();
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
