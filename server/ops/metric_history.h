// What the metrics said in the last hour, for plots that begin before anybody looked.
#pragma once

#include <chrono>
#include <cstddef>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <absl/strings/string_view.h>

namespace tet {

/// Keeps samples of every gauge and counter, none of histograms' buckets, for as long as
/// `kept`; in memory alone, so that it begins anew with the process. Thread-safe.
///
/// It takes 8 bytes a number: at most 240 samples of 1,024 series, which are 2 MB. A series
/// that comes when there are so many is left out, and `left_out_series` of the answer tells.
class MetricHistory {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds kInterval{15};

  explicit MetricHistory(std::chrono::seconds kept = std::chrono::hours(1),
                         std::size_t most_series = 1024);

  /// Adds a sample: metrics in Prometheus' text format, as Metrics::text returns them. Nothing
  /// else comes out of it than numbers; a line that has none is passed over.
  void take(Clock::time_point now, absl::string_view text);

  class Telling;

  /// Tells {"interval_seconds", "left_out_series", "seconds_ago": [...], "samples": {series:
  /// [...]}} of what there is now: ages in seconds, the oldest first, and for each series as
  /// many numbers, null where it was not there. A series is named as in the text:
  /// `name{label="value"}`. `families` are names without labels, separated by commas; all where
  /// it is empty.
  Telling tell(Clock::time_point now, absl::string_view families = {}) const;

 private:
  struct Sample {
    Clock::time_point time;
    std::vector<double> values;  ///< by series; those that came later are missing
  };

  const std::chrono::seconds kept_;
  const std::size_t most_series_;
  mutable std::mutex mutex_;
  std::map<std::string, std::size_t, std::less<>> series_;  ///< their places in a sample
  std::size_t left_out_ = 0;                                ///< of the newest sample
  std::deque<std::shared_ptr<const Sample>> samples_;
};

/// JSON of what was kept at one moment, a piece at a time: all of it may be megabytes, which
/// take tens of milliseconds to write. Not thread-safe; may outlive the history.
class MetricHistory::Telling {
 public:
  static constexpr std::size_t kSeriesOfPiece = 16;

  /// The next bytes: at most kSeriesOfPiece series. Empty once all are told.
  std::string next();

 private:
  friend class MetricHistory;
  struct Series {
    std::string name;
    std::size_t place = 0;  ///< in a sample
  };
  void append(const Series& series, std::string& json) const;

  std::string head_;  ///< of the answer, until it is told
  std::deque<std::shared_ptr<const Sample>> samples_;
  std::vector<Series> series_;
  std::size_t told_ = 0;  ///< series
  bool ended_ = false;
};

}  // namespace tet
