#include "core/plan/label_choice.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include <absl/strings/ascii.h>
#include <absl/strings/escaping.h>
#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_split.h>

#include "core/base/utf8.h"
#include "core/mesh/tet_mesh.h"

namespace tet {
namespace {

absl::Status wrong_labels(const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat(kLabelsField, ".", what));
}

absl::StatusOr<LabelRange> parse_label_range(const std::string& text) {
  const std::vector<std::string> ends = absl::StrSplit(text, ':');
  LabelRange range;
  if (ends.size() <= 2 && absl::SimpleAtoi(ends.front(), &range.first) &&
      absl::SimpleAtoi(ends.back(), &range.last) && range.first <= range.last) {
    return range;
  }
  return absl::InvalidArgumentError(
      absl::StrFormat("'%s' names no labels: it takes numbers and ranges, such as 1,4,7:12, or "
                      "all",
                      absl::CHexEscape(text.substr(0, 60))));
}

absl::Status check_range(const LabelRange& range, const std::string& field) {
  if (range.first <= range.last) return absl::OkStatus();
  return wrong_labels(
      absl::StrFormat("%s is from %d to %d: its first value must not be above its last", field,
                      range.first, range.last));
}

absl::Status check_ranges(std::span<const LabelRange> ranges, const std::string& field) {
  if (ranges.size() > kMaxLabelRanges) {
    return wrong_labels(absl::StrFormat("%s has %d ranges; the limit is %d", field,
                                        ranges.size(), kMaxLabelRanges));
  }
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    auto status = check_range(ranges[i], absl::StrFormat("%s[%d]", field, i));
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

/// Whether no value is in two merges, nor twice in one.
absl::Status check_merges(const LabelChoice& choice) {
  std::vector<LabelRange> all;
  for (std::size_t i = 0; i < choice.merges.size(); ++i) {
    const std::string field = absl::StrFormat("merges[%d].ranges", i);
    if (choice.merges[i].empty())
      return wrong_labels(field + " is empty: name labels to merge");
    if (auto status = check_ranges(choice.merges[i], field); !status.ok()) return status;
    all.insert(all.end(), choice.merges[i].begin(), choice.merges[i].end());
    if (auto status = check_ranges(all, "merges"); !status.ok()) return status;
  }
  std::ranges::sort(all, {}, &LabelRange::first);
  for (std::size_t i = 1; i < all.size(); ++i) {
    if (all[i].first > all[i - 1].last) continue;
    return wrong_labels(absl::StrFormat("merges have label %d twice: %s and %s overlap",
                                        all[i].first, text_of(all[i - 1]), text_of(all[i])));
  }
  return absl::OkStatus();
}

absl::Status check_sizes(std::span<const LabelSize> sizes) {
  if (sizes.size() > kMaxLabelSizes) {
    return wrong_labels(
        absl::StrFormat("sizes has %d entries; the limit is %d", sizes.size(), kMaxLabelSizes));
  }
  constexpr double kLeast = 1e-15, kMost = 1e15;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    if (auto s = check_range(sizes[i].labels, absl::StrFormat("sizes[%d].labels", i));
        !s.ok()) {
      return s;
    }
    if (sizes[i].size >= kLeast && sizes[i].size <= kMost) continue;
    return wrong_labels(absl::StrFormat("sizes[%d].size %g is not from %g to %g", i,
                                        sizes[i].size, kLeast, kMost));
  }
  return absl::OkStatus();
}

absl::Status check_names(std::span<const LabelName> names) {
  if (names.size() > kMaxMeshLabels) {
    return wrong_labels(
        absl::StrFormat("names has %d entries; the limit is %d", names.size(), kMaxMeshLabels));
  }
  std::vector<std::int64_t> values;
  for (std::size_t i = 0; i < names.size(); ++i) {
    values.push_back(names[i].value);
    if (is_label_name(names[i].name)) continue;
    return wrong_labels(absl::StrFormat(
        "names[%d].name \"%s\" cannot name a label: it takes UTF-8 of 1 to %d bytes without "
        "control characters",
        i, absl::CHexEscape(names[i].name.substr(0, kMaxLabelNameBytes)), kMaxLabelNameBytes));
  }
  std::ranges::sort(values);
  const auto twice = std::ranges::adjacent_find(values);
  if (twice == values.end()) return absl::OkStatus();
  return wrong_labels(absl::StrFormat("names has label %d twice: give it one name", *twice));
}

}  // namespace

absl::StatusOr<std::vector<LabelRange>> parse_label_ranges(std::string_view text) {
  std::vector<LabelRange> ranges;
  if (text == "all") return ranges;
  const std::vector<std::string> parts = absl::StrSplit(std::string(text), ',');
  for (const std::string& part : parts) {
    const absl::StatusOr<LabelRange> range = parse_label_range(part);
    if (!range.ok()) return range.status();
    ranges.push_back(*range);
  }
  return ranges;
}

std::string text_of(const LabelRange& range) {
  return range.first == range.last ? absl::StrCat(range.first)
                                   : absl::StrCat(range.first, ":", range.last);
}

absl::Status check_label_choice(const LabelChoice& choice) {
  if (auto status = check_ranges(choice.only, "only"); !status.ok()) return status;
  if (auto status = check_merges(choice); !status.ok()) return status;
  if (auto status = check_names(choice.names); !status.ok()) return status;
  if (auto status = check_sizes(choice.sizes); !status.ok()) return status;
  const bool is_smoothed = choice.kernel == LabelKernel::kGauss;
  if (is_smoothed && !(choice.smooth > 0 && choice.smooth <= kMostSmooth)) {
    return wrong_labels(
        absl::StrFormat("smooth %g is not from 0 to %g voxels", choice.smooth, kMostSmooth));
  }
  return absl::OkStatus();
}

bool is_label_name(std::string_view name) {
  return !name.empty() && name.size() <= kMaxLabelNameBytes && is_utf8(name) &&
         std::ranges::none_of(name, [](unsigned char c) { return absl::ascii_iscntrl(c); });
}

}  // namespace tet
