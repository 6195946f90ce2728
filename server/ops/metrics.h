// What the server counts of its calls, and how Prometheus reads it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <absl/status/status.h>

namespace tet {

/// A number that is read only when somebody asks for the metrics.
struct Reading {
  enum class Kind { kGauge, kCounter };

  std::string name, help;
  Kind kind = Kind::kGauge;
  double value = 0;
  std::vector<std::pair<std::string, std::string>> labels;
};

template <class Number>
Reading gauge(const char* name, const char* help, Number value) {
  return {name, help, Reading::Kind::kGauge, static_cast<double>(value), {}};
}

/// `name` ends in _total, and `value` never falls.
template <class Number>
Reading counter(const char* name,
                const char* help,
                Number value,
                std::vector<std::pair<std::string, std::string>> labels = {}) {
  return {name, help, Reading::Kind::kCounter, static_cast<double>(value), std::move(labels)};
}

/// Counts calls and what they carry, from when it is made on.
///
/// Every label has a bounded set of values: methods and codes are those there are, reasons
/// those of docs/errors.md. Thread safety: any thread may call any member. What is counted per
/// chunk or piece takes no lock; what is counted per call takes one for a moment.
class Metrics {
 public:
  using Reader = std::function<std::vector<Reading>()>;

  Metrics();
  ~Metrics();

  /// A call of `method` ended. `reason` is the ErrorInfo's, empty for kOk.
  void call_ended(const std::string& method,
                  absl::StatusCode code,
                  std::string_view reason,
                  double seconds);
  void planned(double seconds);
  /// Counts the time from a call's arrival until the transport took its first chunk.
  void first_chunk(double seconds);

  void chunk_sent(std::uint64_t tets, std::uint64_t bytes) noexcept;
  void points_sampled(std::uint64_t points, std::uint64_t bytes) noexcept;
  void upload_received(std::uint64_t bytes) noexcept;

  /// Everything, with what `reader` says now, in Prometheus' text format 0.0.4.
  std::string text(const Reader& reader) const;

 private:
  struct Families;
  std::unique_ptr<Families> families_;
};

}  // namespace tet
