#include "server/ops/metric_history.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include <absl/strings/match.h>
#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_split.h>
#include <nlohmann/json.hpp>

namespace tet {

namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

/// `name` of `name{label="value"}`.
absl::string_view family_of(absl::string_view series) {
  return series.substr(0, series.find('{'));
}

/// A line of the text format as a series and its value; the series is empty for other lines.
std::pair<absl::string_view, double> read_line(absl::string_view line) {
  const std::size_t space = line.rfind(' ');
  double value = kMissing;
  if (line.empty() || line[0] == '#' || space == absl::string_view::npos ||
      !absl::SimpleAtod(line.substr(space + 1), &value)) {
    return {};
  }
  const absl::string_view series = line.substr(0, space);
  // Sixteen numbers a histogram, whose sum and count tell enough of an hour.
  if (absl::EndsWith(family_of(series), "_bucket")) return {};
  return {series, value};
}

/// The shortest text that reads as the same number; null where it is none.
void append_number(double value, std::string& json) {
  if (!std::isfinite(value)) {
    json += "null";
    return;
  }
  std::array<char, 32> text;
  json.append(text.data(), std::to_chars(text.begin(), text.end(), value).ptr);
}

}  // namespace

MetricHistory::MetricHistory(std::chrono::seconds kept, std::size_t most_series)
    : kept_(kept), most_series_(most_series) {}

void MetricHistory::take(Clock::time_point now, absl::string_view text) {
  const std::lock_guard lock(mutex_);
  auto sample =
      std::make_shared<Sample>(Sample{now, std::vector<double>(series_.size(), kMissing)});
  left_out_ = 0;
  for (const absl::string_view line : absl::StrSplit(text, '\n')) {
    const auto [series, value] = read_line(line);
    if (series.empty()) continue;
    auto found = series_.find(series);
    if (found == series_.end() && series_.size() < most_series_) {
      found = series_.emplace(series, series_.size()).first;
      sample->values.push_back(kMissing);
    }
    if (found == series_.end()) {
      ++left_out_;
    } else {
      sample->values[found->second] = value;
    }
  }
  samples_.push_back(std::move(sample));
  while (now - samples_.front()->time > kept_) samples_.pop_front();
}

MetricHistory::Telling MetricHistory::tell(Clock::time_point now,
                                           absl::string_view families) const {
  const std::set<absl::string_view> wanted = absl::StrSplit(families, ',', absl::SkipEmpty());
  Telling telling;
  const std::lock_guard lock(mutex_);
  telling.samples_ = samples_;
  for (const auto& [name, place] : series_) {
    if (wanted.empty() || wanted.contains(family_of(name))) {
      telling.series_.push_back({name, place});
    }
  }
  telling.head_ = absl::StrCat("{\"interval_seconds\":", kInterval.count(),
                               ",\"left_out_series\":", left_out_, ",\"seconds_ago\":[");
  const char* comma = "";
  for (const auto& sample : samples_) {
    telling.head_ += std::exchange(comma, ",");
    // A sample may have been taken after whoever asks looked at the clock.
    const auto age = std::max(now - sample->time, Clock::duration::zero());
    append_number(std::chrono::duration<double>(age).count(), telling.head_);
  }
  telling.head_ += "],\"samples\":{";
  return telling;
}

std::string MetricHistory::Telling::next() {
  std::string json = std::exchange(head_, {});
  const std::size_t end = std::min(series_.size(), told_ + kSeriesOfPiece);
  for (; told_ < end; ++told_) append(series_[told_], json);
  if (told_ == series_.size() && !std::exchange(ended_, true)) json += "}}";
  return json;
}

void MetricHistory::Telling::append(const Series& series, std::string& json) const {
  using Json = nlohmann::json;
  if (told_ > 0) json += ",";
  json += Json(series.name).dump(-1, ' ', false, Json::error_handler_t::replace);
  const char* before = ":[";
  for (const auto& sample : samples_) {
    json += std::exchange(before, ",");
    append_number(
        series.place < sample->values.size() ? sample->values[series.place] : kMissing, json);
  }
  json += samples_.empty() ? ":[]" : "]";
}

}  // namespace tet
