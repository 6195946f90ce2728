// Readers of images against anything: they accept or refuse, in words that can be shown; and
// what they accept of a header is what a volume of it then has.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/image/load_image.h"
#include "core/image/outline_image.h"
#include "tests/fuzz/fuzz_target.h"

namespace tet::image_fuzz {
namespace {

void require_told(const absl::Status& status) {
  require(absl::IsInvalidArgument(status) || absl::IsFailedPrecondition(status));
  require(!status.message().empty() && status.message().size() <= 600);
}

/// More is left to the limits of whoever reads it.
constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 22;

}  // namespace

TET_FUZZ_TARGET(image_fuzz) {
  const ByteSource source(std::as_bytes(std::span(data, size)));
  const auto outline = outline_image(source);
  if (!outline.ok()) {
    require_told(outline.status());
    return 0;
  }
  if (outline->reading_bytes(size) > kMostBytes * 4) return 0;
  const auto arrays = list_image(source);
  if (!arrays.ok()) {
    require_told(arrays.status());
    return 0;
  }
  for (const GridInfo& array : *arrays) {
    if (!array.not_meshable.empty() || array.active_voxels > kMostBytes) continue;
    const auto volume = load_image(source, array.name, ImageUse::kSurface);
    if (volume.ok()) {
      for (const float value : volume->values) require(std::isfinite(value));
    } else {
      require_told(volume.status());
    }
    const auto labels = load_labels(source, array.name);
    if (!labels.ok()) {
      require_told(labels.status());
      continue;
    }
    std::uint64_t voxels = 0;
    for (const std::uint64_t count : labels->voxel_counts) voxels += count;
    require(voxels == array.active_voxels);
  }
  return 0;
}

}  // namespace tet::image_fuzz
