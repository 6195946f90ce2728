#include "server/ops/metric_history.h"

#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include <absl/strings/match.h>
#include <absl/strings/numbers.h>
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

}  // namespace

MetricHistory::MetricHistory(std::chrono::seconds kept, std::size_t most_series)
    : kept_(kept), most_series_(most_series) {}

void MetricHistory::take(Clock::time_point now, absl::string_view text) {
  const std::lock_guard lock(mutex_);
  Sample sample{now, std::vector<double>(series_.size(), kMissing)};
  left_out_ = 0;
  for (const absl::string_view line : absl::StrSplit(text, '\n')) {
    const auto [series, value] = read_line(line);
    if (series.empty()) continue;
    auto found = series_.find(series);
    if (found == series_.end() && series_.size() < most_series_) {
      found = series_.emplace(series, series_.size()).first;
      sample.values.push_back(kMissing);
    }
    if (found == series_.end()) {
      ++left_out_;
    } else {
      sample.values[found->second] = value;
    }
  }
  samples_.push_back(std::move(sample));
  while (now - samples_.front().time > kept_) samples_.pop_front();
}

std::string MetricHistory::json(Clock::time_point now, absl::string_view families) const {
  const std::set<absl::string_view> wanted = absl::StrSplit(families, ',', absl::SkipEmpty());
  const std::lock_guard lock(mutex_);
  nlohmann::json answer = {{"interval_seconds", kInterval.count()},
                           {"left_out_series", left_out_},
                           {"seconds_ago", nlohmann::json::array()},
                           {"samples", nlohmann::json::object()}};
  for (const Sample& sample : samples_) {
    answer["seconds_ago"].push_back(std::chrono::duration<double>(now - sample.time).count());
  }
  for (const auto& [series, place] : series_) {
    if (!wanted.empty() && !wanted.contains(family_of(series))) continue;
    nlohmann::json& values = answer["samples"][series] = nlohmann::json::array();
    for (const Sample& sample : samples_) {
      const double value = place < sample.values.size() ? sample.values[place] : kMissing;
      values.push_back(std::isfinite(value) ? nlohmann::json(value) : nlohmann::json());
    }
  }
  return answer.dump();
}

}  // namespace tet
