#include "bench/load/latency_histogram.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace tet::load {

namespace {

/// Values of 2^10 to 2^11 have a bucket each; every further power of two has as many buckets.
constexpr int kPartBits = 10;

std::size_t bucket_of(std::uint64_t ns) noexcept {
  const int shift = std::max(static_cast<int>(std::bit_width(ns)) - (kPartBits + 1), 0);
  return (static_cast<std::size_t>(shift) << kPartBits) + static_cast<std::size_t>(ns >> shift);
}

/// The largest value that falls into a bucket, ns.
std::uint64_t top_of(std::size_t bucket) noexcept {
  const std::size_t octave = bucket >> kPartBits;
  const std::size_t shift = octave > 1 ? octave - 1 : 0;
  const std::uint64_t part = bucket - (shift << kPartBits);
  return ((part + 1) << shift) - 1;
}

std::uint64_t whole_ns(Nanoseconds latency) noexcept {
  return static_cast<std::uint64_t>(std::max<Nanoseconds::rep>(latency.count(), 0));
}

}  // namespace

void LatencyHistogram::add(Nanoseconds latency) {
  const std::uint64_t ns = whole_ns(latency);
  const std::size_t bucket = bucket_of(ns);
  if (bucket >= counts_.size()) counts_.resize(bucket + 1);
  ++counts_[bucket];
  ++count_;
  sum_ns_ += static_cast<double>(ns);
  max_ = std::max(max_, latency);
}

void LatencyHistogram::add(const LatencyHistogram& other) {
  if (counts_.size() < other.counts_.size()) counts_.resize(other.counts_.size());
  for (std::size_t i = 0; i < other.counts_.size(); ++i) counts_[i] += other.counts_[i];
  count_ += other.count_;
  sum_ns_ += other.sum_ns_;
  max_ = std::max(max_, other.max_);
}

Nanoseconds LatencyHistogram::mean() const noexcept {
  if (count_ == 0) return Nanoseconds{0};
  return Nanoseconds(std::llround(sum_ns_ / static_cast<double>(count_)));
}

Nanoseconds LatencyHistogram::quantile(double fraction) const noexcept {
  const double rank = std::ceil(fraction * static_cast<double>(count_));
  const std::uint64_t wanted = std::clamp(static_cast<std::uint64_t>(std::max(rank, 1.0)),
                                          std::uint64_t{1}, std::max(count_, std::uint64_t{1}));
  std::uint64_t seen = 0;
  for (std::size_t bucket = 0; bucket < counts_.size(); ++bucket) {
    seen += counts_[bucket];
    if (seen >= wanted) return std::min(Nanoseconds(top_of(bucket)), max_);
  }
  return max_;
}

std::uint64_t LatencyHistogram::count_above(Nanoseconds limit) const noexcept {
  std::uint64_t above = 0;
  for (std::size_t i = bucket_of(whole_ns(limit)) + 1; i < counts_.size(); ++i) {
    above += counts_[i];
  }
  return above;
}

}  // namespace tet::load
