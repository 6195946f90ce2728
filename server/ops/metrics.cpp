#include "server/ops/metrics.h"

#include <map>
#include <prometheus/counter.h>
#include <prometheus/family.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>
#include <prometheus/text_serializer.h>

#include "proto/convert/reasons.h"

namespace tet {

namespace {

using prometheus::Counter;
using prometheus::Histogram;

/// Seconds: from an answer out of memory to a mesh of a billion tets.
const Histogram::BucketBoundaries kSeconds = {
    0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1, 2.5, 5, 10, 30, 60, 300};

prometheus::Family<Counter>& counters(prometheus::Registry& registry,
                                      const char* name,
                                      const char* help) {
  return prometheus::BuildCounter().Name(name).Help(help).Register(registry);
}

prometheus::Family<Histogram>& histograms(prometheus::Registry& registry,
                                          const char* name,
                                          const char* help) {
  return prometheus::BuildHistogram().Name(name).Help(help).Register(registry);
}

prometheus::ClientMetric to_metric(const Reading& reading) {
  prometheus::ClientMetric metric;
  for (const auto& [name, value] : reading.labels) metric.label.push_back({name, value});
  metric.gauge.value = metric.counter.value = reading.value;
  return metric;
}

/// Readings of one name make one family, wherever they stand.
std::vector<prometheus::MetricFamily> to_families(const std::vector<Reading>& readings) {
  std::map<std::string, prometheus::MetricFamily> families;
  for (const Reading& reading : readings) {
    prometheus::MetricFamily& family = families[reading.name];
    family.name = reading.name;
    family.help = reading.help;
    family.type = reading.kind == Reading::Kind::kCounter ? prometheus::MetricType::Counter
                                                          : prometheus::MetricType::Gauge;
    family.metric.push_back(to_metric(reading));
  }
  std::vector<prometheus::MetricFamily> list;
  list.reserve(families.size());
  for (auto& [name, family] : families) list.push_back(std::move(family));
  return list;
}

}  // namespace

struct Metrics::Families {
  prometheus::Registry registry;
  prometheus::Family<Counter>& calls =
      counters(registry, "tetstream_calls_total", "Calls that ended, by method and gRPC code.");
  prometheus::Family<Counter>& refusals = counters(
      registry, "tetstream_refusals_total", "Calls that failed, by gRPC code and reason.");
  prometheus::Family<Histogram>& durations =
      histograms(registry,
                 "tetstream_call_duration_seconds",
                 "From a call's arrival to its end, by method.");
  Histogram& plan_seconds =
      histograms(registry, "tetstream_plan_seconds", "Loading and counting a mesh.")
          .Add({}, kSeconds);
  Histogram& first_chunk_seconds =
      histograms(registry,
                 "tetstream_first_chunk_seconds",
                 "From a stream's arrival until its first chunk was taken by the transport.")
          .Add({}, kSeconds);
  Counter& chunks =
      counters(registry, "tetstream_sent_chunks_total", "Chunks of meshes sent.").Add({});
  Counter& tets =
      counters(registry, "tetstream_sent_tets_total", "Tets in the chunks sent.").Add({});
  Counter& bytes =
      counters(registry, "tetstream_sent_bytes_total", "Bytes of the chunks sent.").Add({});
  Counter& points =
      counters(registry, "tetstream_sampled_points_total", "Points whose samples were sent.")
          .Add({});
  Counter& sample_bytes =
      counters(registry, "tetstream_sampled_bytes_total", "Bytes of samples sent.").Add({});
  Counter& upload_bytes =
      counters(registry, "tetstream_upload_bytes_total", "Bytes of grid files received.")
          .Add({});
};

Metrics::Metrics() : families_(std::make_unique<Families>()) {}

Metrics::~Metrics() = default;

void Metrics::call_ended(const std::string& method,
                         absl::StatusCode code,
                         std::string_view reason,
                         double seconds) {
  const std::string code_name = absl::StatusCodeToString(code);
  families_->calls.Add({{"method", method}, {"code", code_name}}).Increment();
  families_->durations.Add({{"method", method}}, kSeconds).Observe(seconds);
  if (code == absl::StatusCode::kOk) return;
  const std::string name(is_reason(reason) ? reason : "OTHER");
  families_->refusals.Add({{"code", code_name}, {"reason", name}}).Increment();
}

void Metrics::planned(double seconds) { families_->plan_seconds.Observe(seconds); }

void Metrics::first_chunk(double seconds) { families_->first_chunk_seconds.Observe(seconds); }

void Metrics::chunk_sent(std::uint64_t tets, std::uint64_t bytes) noexcept {
  families_->chunks.Increment();
  families_->tets.Increment(static_cast<double>(tets));
  families_->bytes.Increment(static_cast<double>(bytes));
}

void Metrics::points_sampled(std::uint64_t points, std::uint64_t bytes) noexcept {
  families_->points.Increment(static_cast<double>(points));
  families_->sample_bytes.Increment(static_cast<double>(bytes));
}

void Metrics::upload_received(std::uint64_t bytes) noexcept {
  families_->upload_bytes.Increment(static_cast<double>(bytes));
}

std::string Metrics::text(const Reader& reader) const {
  std::vector<prometheus::MetricFamily> all = families_->registry.Collect();
  const std::vector<prometheus::MetricFamily> read = to_families(reader());
  all.insert(all.end(), read.begin(), read.end());
  return prometheus::TextSerializer().Serialize(all);
}

}  // namespace tet
