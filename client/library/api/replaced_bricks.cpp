#include "client/library/api/replaced_bricks.h"

#include <cstddef>
#include <cstdint>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "client/library/api/volume_impl.h"
#include "core/base/brick_box.h"
#include "core/base/brick_sets.h"
#include "core/volume/check_replaced.h"

namespace tetstream {
namespace {

absl::Status check(const SampleBox& box) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int32_t begin = box.begin[axis], end = box.end[axis];
    if (begin > end) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "a replaced box ends at %d and begins at %d along axis %d: it has to begin first",
          end, begin, axis));
    }
    if (begin < -tet::kMaxVoxelCoord || end > tet::kMaxVoxelCoord) {
      return absl::InvalidArgumentError(
          absl::StrFormat("a replaced box goes from %d to %d along axis %d: samples lie within "
                          "-%d and %d",
                          begin, end, axis, tet::kMaxVoxelCoord, tet::kMaxVoxelCoord));
    }
  }
  return absl::OkStatus();
}

bool is_empty(const SampleBox& box) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (box.begin[axis] == box.end[axis]) return true;
  }
  return false;
}

tet::BrickBox bricks_of(const SampleBox& box) {
  return {{box.begin[0] >> 3, box.begin[1] >> 3, box.begin[2] >> 3},
          {(box.end[0] - 1) >> 3, (box.end[1] - 1) >> 3, (box.end[2] - 1) >> 3}};
}

}  // namespace

absl::StatusOr<std::optional<std::vector<tet::BrickCoord>>> replaced_bricks(
    const Volume& before, const Volume& after, const ReplacedBoxes& boxes) {
  if (!boxes) return std::nullopt;
  const tet::Volume& was = *before.impl().components.front();
  const tet::Volume& is = *after.impl().components.front();
  double bricks = 0;
  for (const SampleBox& box : *boxes) {
    if (absl::Status status = check(box); !status.ok()) return status;
    if (!is_empty(box)) bricks += tet::bricks_in(bricks_of(box));
  }
  const auto most = static_cast<double>(was.bricks.size() + is.bricks.size());
  if (bricks > most || !tet::alike_but_for_leaves(was, is)) return std::nullopt;
  std::vector<tet::BrickCoord> replaced;
  for (const SampleBox& box : *boxes) {
    if (is_empty(box)) continue;
    tet::for_each_brick(bricks_of(box),
                        [&](tet::BrickCoord brick) { replaced.push_back(brick); });
  }
  tet::sort_unique(replaced);
  if (absl::Status status = tet::check_replaced(was, is, replaced); !status.ok()) return status;
  // Boxes may hold much that is as it was, and all that is named is planned anew.
  return tet::changed_among(was, is, replaced);
}

}  // namespace tetstream
