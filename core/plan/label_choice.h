// What a caller asks of a segmentation: which of its labels, merged how, under which names.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/labels/label_kernel.h"

namespace tet {

/// Values of labels, both ends included.
struct LabelRange {
  std::int64_t first = 0, last = 0;
  bool holds(std::int64_t value) const noexcept { return value >= first && value <= last; }
  friend bool operator==(const LabelRange&, const LabelRange&) = default;
};

/// Holds every value.
inline constexpr LabelRange kEveryLabel{std::numeric_limits<std::int64_t>::min(),
                                        std::numeric_limits<std::int64_t>::max()};

/// Labels that become one, whose value is the first range's first.
using LabelMerge = std::vector<LabelRange>;

struct LabelName {
  std::int64_t value = 0;
  std::string name = {};
  friend bool operator==(const LabelName&, const LabelName&) = default;
};

/// Leaves of these labels, by the values that they have when all is merged, have edges of
/// `size` at most; world units.
struct LabelSize {
  LabelRange labels = {};
  double size = 0;
  friend bool operator==(const LabelSize&, const LabelSize&) = default;
};

struct LabelChoice {
  /// Those that are meshed, by the values that they have when all is merged; empty: all but the
  /// background.
  std::vector<LabelRange> only = {};
  std::vector<LabelMerge> merges = {};  ///< no value is in two of them
  /// What is not chosen becomes this, and what lies beyond the image is it.
  std::int64_t background = 0;
  bool mesh_background = false;
  /// As people call them; names of labels that the image does not have are not looked at.
  std::vector<LabelName> names = {};
  LabelKernel kernel = LabelKernel::kGauss;
  double smooth = kDefaultSmooth;     ///< the Gaussian's width, voxels
  std::vector<LabelSize> sizes = {};  ///< where two hold of a label, the smaller one
  friend bool operator==(const LabelChoice&, const LabelChoice&) = default;
};

/// A longer name of a label is refused.
inline constexpr std::size_t kMaxLabelNameBytes = 128;

/// Ranges of one list, and of all merges together.
inline constexpr std::size_t kMaxLabelRanges = 65535;

/// Each is asked of each label.
inline constexpr std::size_t kMaxLabelSizes = 1024;

/// The choice of a request: what refusals begin with.
inline constexpr char kLabelsField[] = "labels";

/// Reads `1,4,7:12`, or nothing of `all`. Errors: kInvalidArgument, with what is wrong and what
/// is expected.
absl::StatusOr<std::vector<LabelRange>> parse_label_ranges(std::string_view text);

/// "4" or "7:12".
std::string text_of(const LabelRange& range);

/// Checks what can be told without the image. Errors: kInvalidArgument, and the message begins
/// with the field that is wrong, as `labels.merges[3]`, and says its value and what it may be.
absl::Status check_label_choice(const LabelChoice& choice);

/// Whether every file format can tell a label by this name: UTF-8 of 1 to kMaxLabelNameBytes
/// without control characters.
bool is_label_name(std::string_view name);

}  // namespace tet
