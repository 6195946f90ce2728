#include "core/plan/labelled/label_numbers.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <absl/status/status.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_join.h>

namespace tet {
namespace {

/// The labels of an image, the first few of many.
std::string list_labels(const std::vector<std::int64_t>& labels) {
  constexpr std::size_t kShown = 20;
  const auto shown = static_cast<std::ptrdiff_t>(std::min(kShown, labels.size()));
  return absl::StrCat(absl::StrJoin(labels.begin(), labels.begin() + shown, ", "),
                      labels.size() > kShown ? ", ..." : "");
}

/// Whether a sorted list has a value in a range.
bool any_within(const std::vector<std::int64_t>& values, const LabelRange& range) {
  const auto at = std::ranges::lower_bound(values, range.first);
  return at != values.end() && *at <= range.last;
}

absl::Status refuse_labels(const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat(kLabelsField, what));
}

/// What each label's value becomes when all is merged; many ranges of many labels are found by
/// halving.
class MergedValues {
 public:
  explicit MergedValues(const LabelChoice& choice) {
    for (const LabelMerge& merge : choice.merges) {
      for (const LabelRange& range : merge) {
        ranges_.push_back({range, merge.front().first});
      }
    }
    std::ranges::sort(ranges_, {}, [](const Merged& merged) { return merged.range.first; });
  }

  std::int64_t operator()(std::int64_t value) const {
    const auto after = std::ranges::upper_bound(
        ranges_, value, {}, [](const Merged& merged) { return merged.range.first; });
    if (after == ranges_.begin()) return value;
    const Merged& before = *(after - 1);
    return before.range.holds(value) ? before.becomes : value;
  }

 private:
  struct Merged {
    LabelRange range;
    std::int64_t becomes = 0;
  };
  std::vector<Merged> ranges_;  // sorted, without overlap
};

/// Ranges that may overlap, to be asked of many values.
class ChosenValues {
 public:
  explicit ChosenValues(std::vector<LabelRange> ranges) : ranges_(std::move(ranges)) {
    std::ranges::sort(ranges_, {}, &LabelRange::first);
    for (std::size_t i = 1; i < ranges_.size(); ++i) {
      ranges_[i].last = std::max(ranges_[i].last, ranges_[i - 1].last);
    }
  }

  /// No ranges hold everything.
  bool hold(std::int64_t value) const {
    if (ranges_.empty()) return true;
    const auto after = std::ranges::upper_bound(ranges_, value, {}, &LabelRange::first);
    return after != ranges_.begin() && (after - 1)->last >= value;
  }

 private:
  std::vector<LabelRange> ranges_;
};

absl::Status check_merges_of(const LabelVolume& volume, const LabelChoice& choice) {
  for (std::size_t i = 0; i < choice.merges.size(); ++i) {
    for (const LabelRange& range : choice.merges[i]) {
      if (any_within(volume.labels, range)) continue;
      return refuse_labels(
          absl::StrFormat(".merges[%d] names %s, and the image has no such label: it has %s", i,
                          text_of(range), list_labels(volume.labels)));
    }
  }
  return absl::OkStatus();
}

/// `values` are what the image has once all is merged.
absl::Status check_only(const std::vector<std::int64_t>& values, const LabelChoice& choice) {
  for (std::size_t i = 0; i < choice.only.size(); ++i) {
    const LabelRange& range = choice.only[i];
    if (!any_within(values, range)) {
      return refuse_labels(absl::StrFormat(
          ".only[%d] names %s, and the image has no such label%s: it has %s", i, text_of(range),
          choice.merges.empty() ? "" : " once all is merged", list_labels(values)));
    }
    if (range == LabelRange{choice.background, choice.background} && !choice.mesh_background) {
      return refuse_labels(
          absl::StrFormat(".only[%d] names %d, which is the background: have the background "
                          "meshed, or name another background",
                          i, choice.background));
    }
  }
  return absl::OkStatus();
}

std::string name_of_label(const std::vector<LabelName>& sorted, std::int64_t value) {
  const auto at = std::ranges::lower_bound(sorted, value, {}, &LabelName::value);
  return at != sorted.end() && at->value == value ? at->name : std::string();
}

double volume_of_voxel(const VoxelTransform& transform) {
  const auto& [a, b, c] = transform.linear;
  return std::abs(a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
                  a[2] * (b[0] * c[1] - b[1] * c[0]));
}

void sort_unique(std::vector<std::int64_t>& values) {
  std::ranges::sort(values);
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

/// The labels that are meshed, with their names.
std::vector<MeshLabel> meshed_labels(const std::vector<std::int64_t>& values,
                                     const LabelChoice& choice) {
  std::vector<LabelName> names = choice.names;
  std::ranges::sort(names, {}, &LabelName::value);
  std::vector<MeshLabel> labels;
  for (const std::int64_t value : values) {
    labels.push_back({value, name_of_label(names, value)});
  }
  if (choice.mesh_background) {
    labels.push_back({choice.background, name_of_label(names, choice.background)});
  }
  return labels;
}

}  // namespace

absl::StatusOr<LabelNumbers> number_labels(const LabelVolume& volume,
                                           const LabelChoice& choice) {
  if (auto status = check_label_choice(choice); !status.ok()) return status;
  if (auto status = check_merges_of(volume, choice); !status.ok()) return status;
  std::vector<std::int64_t> becomes, values;
  const MergedValues merged(choice);
  for (const std::int64_t value : volume.labels) becomes.push_back(merged(value));
  values = becomes;
  sort_unique(values);
  if (auto status = check_only(values, choice); !status.ok()) return status;
  const ChosenValues chosen(choice.only);
  std::erase_if(values, [&](std::int64_t v) { return !chosen.hold(v); });
  std::erase(values, choice.background);
  if (values.empty()) {
    return absl::FailedPreconditionError(
        absl::StrFormat("the image has no label but %s, and %d is the background: name another "
                        "background, or have it meshed",
                        list_labels(volume.labels), choice.background));
  }
  if (values.size() >= kMaxMeshLabels) {
    return refuse_labels(
        absl::StrFormat(" of the image are %d; the limit is %d. Name those to be meshed, or "
                        "merge some",
                        values.size(), kMaxMeshLabels - 1));
  }
  LabelNumbers numbers;
  numbers.labels = meshed_labels(values, choice);
  // Its number follows theirs whether or not it is meshed: where it ties it loses, and leaving
  // it out changes nothing else.
  numbers.background = static_cast<Label>(values.size());
  const auto number_of = [&](std::int64_t value) {
    const auto at = std::ranges::lower_bound(values, value);
    return at != values.end() && *at == value ? static_cast<Label>(at - values.begin())
                                              : numbers.background;
  };
  if (!choice.mesh_background) numbers.kept.left_out = numbers.background;
  numbers.voxel_volume.resize(numbers.labels.size());
  const double of_voxel = volume_of_voxel(volume.transform);
  for (std::size_t i = 0; i < becomes.size(); ++i) {
    const Label number = chosen.hold(becomes[i]) ? number_of(becomes[i]) : numbers.background;
    numbers.of_image.push_back(number);
    if (number < numbers.labels.size()) {
      numbers.voxel_volume[number] += of_voxel * static_cast<double>(volume.voxel_counts[i]);
    }
  }
  return numbers;
}

}  // namespace tet
