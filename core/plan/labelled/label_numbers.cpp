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

absl::Status check_merges_of(const KnownLabels& known, const LabelChoice& choice) {
  for (std::size_t i = 0; i < choice.merges.size(); ++i) {
    for (const LabelRange& range : choice.merges[i]) {
      if (any_within(known.values, range)) continue;
      return refuse_labels(
          absl::StrFormat(".merges[%d] names %s, and the %s has no such label: it has %s", i,
                          text_of(range), known.of, list_labels(known.values)));
    }
  }
  return absl::OkStatus();
}

/// A label is named that there is not once all is merged.
absl::Status no_such_label(const std::string& field,
                           const LabelRange& range,
                           const KnownLabels& merged,
                           const LabelChoice& choice) {
  return refuse_labels(absl::StrFormat(
      ".%s names %s, and the %s has no such label%s: it has %s", field, text_of(range),
      merged.of, choice.merges.empty() ? "" : " once all is merged",
      list_labels(merged.values)));
}

/// `merged` is what there is once all is merged.
absl::Status check_only(const KnownLabels& merged, const LabelChoice& choice) {
  for (std::size_t i = 0; i < choice.only.size(); ++i) {
    const LabelRange& range = choice.only[i];
    if (!any_within(merged.values, range)) {
      return no_such_label(absl::StrFormat("only[%d]", i), range, merged, choice);
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

/// The background is there where it is meshed, whether or not voxels have it.
absl::Status check_sizes_of(const KnownLabels& merged, const LabelChoice& choice) {
  for (std::size_t i = 0; i < choice.sizes.size(); ++i) {
    const LabelRange& range = choice.sizes[i].labels;
    if (any_within(merged.values, range)) continue;
    if (choice.mesh_background && range.holds(choice.background)) continue;
    return no_such_label(absl::StrFormat("sizes[%d].labels", i), range, merged, choice);
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
  labels.reserve(values.size() + 1);
  for (const std::int64_t value : values) {
    labels.push_back({value, name_of_label(names, value)});
  }
  if (choice.mesh_background) {
    labels.push_back({choice.background, name_of_label(names, choice.background)});
  }
  return labels;
}

/// The smallest size that holds of each label.
std::vector<double> largest_leaves(const std::vector<MeshLabel>& labels,
                                   const LabelChoice& choice) {
  std::vector<double> sizes(labels.size(), LabelNumbers::kAnySize);
  if (choice.sizes.empty()) return sizes;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    for (const LabelSize& size : choice.sizes) {
      if (size.labels.holds(labels[i].value)) sizes[i] = std::min(sizes[i], size.size);
    }
  }
  return sizes;
}

}  // namespace

absl::StatusOr<LabelNumbers> number_labels(const KnownLabels& known,
                                           const LabelChoice& choice) {
  if (auto status = check_label_choice(choice); !status.ok()) return status;
  if (auto status = check_merges_of(known, choice); !status.ok()) return status;
  std::vector<std::int64_t> becomes, values;
  const MergedValues merged(choice);
  for (const std::int64_t value : known.values) becomes.push_back(merged(value));
  values = becomes;
  sort_unique(values);
  if (auto status = check_only({values, known.of}, choice); !status.ok()) return status;
  if (auto status = check_sizes_of({values, known.of}, choice); !status.ok()) return status;
  const ChosenValues chosen(choice.only);
  std::erase_if(values, [&](std::int64_t v) { return !chosen.hold(v); });
  std::erase(values, choice.background);
  if (values.empty()) {
    return absl::FailedPreconditionError(
        absl::StrFormat("the %s has no label but %s, and %d is the background: name another "
                        "background, or have it meshed",
                        known.of, list_labels(known.values), choice.background));
  }
  if (values.size() >= kMaxMeshLabels) {
    return refuse_labels(
        absl::StrFormat(" of the %s are %d; the limit is %d. Name those to be meshed, or "
                        "merge some",
                        known.of, values.size(), kMaxMeshLabels - 1));
  }
  LabelNumbers numbers;
  numbers.labels = meshed_labels(values, choice);
  numbers.largest_leaf = largest_leaves(numbers.labels, choice);
  // Its number follows theirs whether or not it is meshed: where it ties it loses, and leaving
  // it out changes nothing else.
  numbers.background = static_cast<Label>(values.size());
  const auto number_of = [&](std::int64_t value) {
    const auto at = std::ranges::lower_bound(values, value);
    return at != values.end() && *at == value ? static_cast<Label>(at - values.begin())
                                              : numbers.background;
  };
  if (!choice.mesh_background) numbers.kept.left_out = numbers.background;
  for (const std::int64_t value : becomes) {
    numbers.of_known.push_back(chosen.hold(value) ? number_of(value) : numbers.background);
  }
  return numbers;
}

std::vector<double> voxel_volumes_of(const LabelVolume& volume, const LabelNumbers& numbers) {
  std::vector<double> volumes(numbers.labels.size());
  const double of_voxel = volume_of_voxel(volume.transform);
  for (std::size_t i = 0; i < numbers.of_known.size(); ++i) {
    const Label number = numbers.of_known[i];
    if (number >= volumes.size()) continue;
    volumes[number] += of_voxel * static_cast<double>(volume.voxel_counts[i]);
  }
  return volumes;
}

}  // namespace tet
