// What the values of a grid tell: their range, the inside, and which labels there are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/types.h"
#include "core/volume/grid_info.h"
#include "core/volume/label_volume.h"
#include "core/volume/volume.h"

namespace tet {

/// Tells of a grid that can be meshed.
struct GridValues {
  ValueRange range;      ///< of all values, the background among them
  float background = 0;  ///< of an image, what lies beyond it
  InsideSide inside = InsideSide::kBelow;
  KindSource source = KindSource::kMaker;  ///< who says what is inside

  friend bool operator==(const GridValues& a, const GridValues& b) {
    return a.range.min == b.range.min && a.range.max == b.range.max &&
           a.background == b.background && a.inside == b.inside && a.source == b.source;
  }
};

/// One label of a segmentation.
struct LabelExtent {
  std::int64_t value = 0;
  std::uint64_t voxels = 0;
  VoxelBox box;  ///< around them

  friend bool operator==(const LabelExtent& a, const LabelExtent& b) {
    return a.value == b.value && a.voxels == b.voxels && a.box.min == b.box.min &&
           a.box.max == b.box.max;
  }
};

/// More labels than these are counted, and not listed.
inline constexpr std::size_t kMostListedLabels = 4096;

struct GridContents {
  std::optional<GridValues> values = {};
  std::string not_meshable = {};         ///< why not, where only the values tell
  std::uint64_t label_count = 0;         ///< 0: it is no segmentation
  std::vector<LabelExtent> labels = {};  ///< the lowest values, kMostListedLabels at most
};

GridValues values_of(const Volume& volume) noexcept;

/// Whether reading it may show that it is a segmentation: one of whole numbers.
bool may_have_labels(const GridInfo& grid);

/// Fills in what a segmentation tells.
void set_labels_of(const LabelVolume& volume, GridContents& contents);

}  // namespace tet
