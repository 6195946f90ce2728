// Percentiles of any number of latencies in little memory and with a known error.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "bench/load/load_clock.h"

namespace tet::load {

/// Counts of latencies in buckets that are exact below 2.048 us and at most 1/1024 of their
/// value wide above: the layout of HdrHistogram (Tene), powers of two cut into equal parts.
/// Takes as many buckets as its largest value needs, at most 434 KB. Not thread-safe.
class LatencyHistogram {
 public:
  /// A quantile is never below the true one, and above it by at most this part of it.
  static constexpr double kRelativeError = 1.0 / 1024;

  /// A negative latency counts as 0.
  void add(Nanoseconds latency);
  void add(const LatencyHistogram& other);

  std::uint64_t count() const noexcept { return count_; }
  Nanoseconds max() const noexcept { return max_; }  ///< exact; 0 when empty
  Nanoseconds mean() const noexcept;                 ///< exact; 0 when empty

  /// The smallest latency that at least `fraction` of all, and at least one, do not exceed; 0
  /// when empty.
  Nanoseconds quantile(double fraction) const noexcept;

  /// How many are over `limit`; those over it by less than kRelativeError may not count.
  std::uint64_t count_above(Nanoseconds limit) const noexcept;

 private:
  std::vector<std::uint64_t> counts_;
  std::uint64_t count_ = 0;
  double sum_ns_ = 0;
  Nanoseconds max_{0};
};

}  // namespace tet::load
