#include "client/library/api/labelled_array.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <variant>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "core/volume/check_transform.h"

namespace tetstream {
namespace {

absl::Status check_sizes(const LabelArray& labels) {
  const auto [x, y, z] = labels.size;
  const auto most = static_cast<std::size_t>(tet::kMaxVoxelCoord);
  if (x == 0 || y == 0 || z == 0 || std::max({x, y, z}) > most) {
    return absl::InvalidArgumentError(
        absl::StrFormat("size %d x %d x %d: each must be 1 to %d", x, y, z, most));
  }
  const std::size_t values =
      std::visit([](const auto& stored) { return stored.size(); }, labels.values);
  if (values / x / y == z && values % (x * y) == 0) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrFormat("size %d x %d x %d does not agree with %d labels", x, y, z, values));
}

tet::VoxelTransform transform_of(const LabelArray& labels) {
  tet::VoxelTransform transform;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t row = 0; row < 3; ++row) {
      transform.linear[row][axis] = labels.steps[axis][row];
    }
  }
  transform.translation = labels.origin;
  transform.voxel_size = tet::voxel_edge(transform);
  return transform;
}

using Voxel = std::array<std::size_t, 3>;

template <class T>
class ArrayBricks {
 public:
  ArrayBricks(std::span<const T> values, const Voxel& size) : values_(values), size_(size) {}

  absl::Status add_all(tet::LabelVolumeBuilder& builder) {
    Voxel begin{};
    for (begin[0] = 0; begin[0] < size_[0]; begin[0] += kEdge) {
      for (begin[1] = 0; begin[1] < size_[1]; begin[1] += kEdge) {
        for (begin[2] = 0; begin[2] < size_[2]; begin[2] += kEdge) {
          if (absl::Status s = add(begin, builder); !s.ok()) return s;
        }
      }
    }
    return absl::OkStatus();
  }

 private:
  static constexpr std::size_t kEdge = tet::kBrickEdge;

  absl::Status add(const Voxel& begin, tet::LabelVolumeBuilder& builder) {
    if (absl::Status s = gather(begin); !s.ok()) return s;
    const auto brick = [&](std::size_t axis) {
      return static_cast<std::int32_t>(begin[axis] / kEdge);
    };
    return builder.add_brick({brick(0), brick(1), brick(2)}, brick_);
  }

  absl::Status gather(const Voxel& begin) {
    Voxel end{};
    for (std::size_t i = 0; i < 3; ++i) end[i] = std::min(begin[i] + kEdge, size_[i]);
    for (std::size_t x = begin[0]; x < end[0]; ++x) {
      for (std::size_t y = begin[1]; y < end[1]; ++y) {
        const std::size_t row = (x * size_[1] + y) * size_[2];
        const std::size_t to = ((x - begin[0]) * kEdge + (y - begin[1])) * kEdge;
        for (std::size_t z = begin[2]; z < end[2]; ++z) {
          const T label = values_[row + z];
          if (!std::in_range<std::int64_t>(label)) return too_large(label, {x, y, z});
          // NOLINTNEXTLINE(bugprone-signed-char-misuse): signed bytes are numbers.
          brick_[to + z - begin[2]] = static_cast<std::int64_t>(label);
        }
      }
    }
    return absl::OkStatus();
  }

  static absl::Status too_large(T label, const Voxel& at) {
    return absl::InvalidArgumentError(
        absl::StrFormat("voxel (%d, %d, %d) has the label %d; the limit is %d", at[0], at[1],
                        at[2], label, std::numeric_limits<std::int64_t>::max()));
  }

  std::span<const T> values_;
  Voxel size_;
  std::array<std::int64_t, tet::kBrickCells> brick_{};
};

}  // namespace

absl::StatusOr<tet::LabelVolume> labels_of_array(const LabelArray& labels) {
  if (absl::Status status = check_sizes(labels); !status.ok()) return status;
  const tet::VoxelTransform transform = transform_of(labels);
  if (absl::Status status = check_transform(transform); !status.ok()) return status;
  const auto last = [&](std::size_t axis) {
    return static_cast<std::int32_t>(labels.size[axis] - 1);
  };
  tet::LabelVolumeBuilder builder("labels", transform,
                                  {{0, 0, 0}, {last(0), last(1), last(2)}});
  const absl::Status status = std::visit(
      [&]<class T>(std::span<const T> values) {
        return ArrayBricks<T>(values, labels.size).add_all(builder);
      },
      labels.values);
  if (!status.ok()) return status;
  return std::move(builder).build();
}

}  // namespace tetstream
