// What a decoder says of a grid's values, and anything else: it is refused in words that can be
// shown, or it is contents that write the same block again.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "core/base/byte_buffer.h"
#include "core/volume/flat_grid_contents.h"
#include "tests/fuzz/fuzz_target.h"

namespace tet::flat_grid_contents_fuzz {
namespace {

bool is_sound(const GridValues& values) {
  return std::isfinite(values.range.min) && std::isfinite(values.range.max) &&
         std::isfinite(values.background) && values.range.min <= values.range.max;
}

bool is_sound(const LabelExtent& label) {
  const VoxelBox& box = label.box;
  return label.voxels > 0 && box.min.x <= box.max.x && box.min.y <= box.max.y &&
         box.min.z <= box.max.z;
}

/// What callers rely on: labels ascend, and are no more than are listed.
void require_sound(const GridContents& contents) {
  require(!contents.values || is_sound(*contents.values));
  require(contents.labels.size() <= kMostListedLabels);
  require(contents.labels.size() <= contents.label_count);
  for (std::size_t i = 0; i < contents.labels.size(); ++i) {
    require(is_sound(contents.labels[i]));
    require(i == 0 || contents.labels[i - 1].value < contents.labels[i].value);
  }
}

std::vector<std::byte> written(const GridContents& contents) {
  std::vector<std::byte> bytes;
  const absl::Status status =
      write_flat_contents(contents, [&](std::span<const std::byte> piece) {
        bytes.insert(bytes.end(), piece.begin(), piece.end());
        return absl::OkStatus();
      });
  require(status.ok());
  return bytes;
}

bool is_same(const GridContents& a, const GridContents& b) {
  return a.values == b.values && a.label_count == b.label_count && a.labels == b.labels;
}

}  // namespace

TET_FUZZ_TARGET(flat_grid_contents_fuzz) {
  ByteBuffer aligned(size);
  if (size > 0) std::memcpy(aligned.bytes().data(), data, size);
  const auto contents = read_flat_contents(aligned.bytes());
  if (!contents.ok()) {
    require(absl::IsInvalidArgument(contents.status()));
    require(contents.status().message().size() <= 400);
    return 0;
  }
  require_sound(*contents);
  // Numbers that nobody reads may be others: the same is read again.
  const std::vector<std::byte> block = written(*contents);
  require(block.size() == size);
  ByteBuffer again(block.size());
  std::memcpy(again.bytes().data(), block.data(), block.size());
  const auto same = read_flat_contents(again.bytes());
  require(same.ok() && is_same(*same, *contents));
  return 0;
}

}  // namespace tet::flat_grid_contents_fuzz
