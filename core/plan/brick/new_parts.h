// What a mesh does not keep of an earlier one, in the order of numbers.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/brick_mask.h"
#include "core/mesh/stable/splice.h"
#include "core/plan/brick/mesh_difference.h"

namespace tet {

/// Numbers, but for those that runs keep.
class NewNumbers {
 public:
  /// Runs are sorted by `to` and do not overlap there; they outlive this.
  explicit NewNumbers(std::span<const KeptRun> kept);

  /// How many there are below a number.
  std::uint64_t before(std::uint64_t number) const noexcept;

  /// Calls `visit(offset, count)` for the runs of them among `count` numbers from `first` on.
  template <class Visit>
  void for_each_run(std::uint64_t first, std::uint64_t count, const Visit& visit) const;

 private:
  /// The first run that ends behind a number.
  std::size_t run_behind(std::uint64_t number) const noexcept;

  std::span<const KeptRun> kept_;
  std::vector<std::uint64_t> kept_before_;  ///< numbers of runs before each, and of all
};

/// What is new in the bricks of a mesh. Immutable; does not move, nor does what it is of.
class NewParts {
 public:
  explicit NewParts(const MeshDifference& difference)
      : vertices_(difference.kept.vertices),
        tets_(difference.kept.tets),
        partly_(difference.partly) {}

  /// How much of a run of the mesh is new, and how much is before that; without faces.
  ChunkExtent within(const ChunkExtent& whole) const noexcept;
  /// The cells of a brick whose tets are new; null where all are.
  const BrickMask* cells(std::size_t brick) const noexcept;
  const NewNumbers& vertices() const noexcept { return vertices_; }

 private:
  NewNumbers vertices_, tets_;
  std::span<const PartlyNew> partly_;
};

template <class Visit>
void NewNumbers::for_each_run(std::uint64_t first,
                              std::uint64_t count,
                              const Visit& visit) const {
  const std::uint64_t end = first + count;
  std::uint64_t at = first;
  for (std::size_t i = run_behind(first); at < end; ++i) {
    const std::uint64_t kept = i < kept_.size() ? std::min(kept_[i].to, end) : end;
    if (at < kept) visit(at - first, kept - at);
    if (i == kept_.size()) return;
    at = std::max(at, kept_[i].to + kept_[i].count);
  }
}

}  // namespace tet
