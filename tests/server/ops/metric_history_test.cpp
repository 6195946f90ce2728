#include "server/ops/metric_history.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "server/ops/metrics.h"

namespace tet {
namespace {

using namespace std::chrono_literals;

const MetricHistory::Clock::time_point kStart(100h);

nlohmann::json told(const MetricHistory& history,
                    MetricHistory::Clock::time_point now,
                    const std::string& families = "") {
  MetricHistory::Telling telling = history.tell(now, families);
  std::string json;
  for (std::string piece = telling.next(); !piece.empty(); piece = telling.next())
    json += piece;
  return nlohmann::json::parse(json);
}

TEST(MetricHistory, SaysWhenEverySampleWasTakenAndWhatItWas) {
  MetricHistory history;
  history.take(kStart, "# HELP a_total Some.\n# TYPE a_total counter\na_total 3\nb 1.5\n");
  history.take(kStart + 15s, "a_total 123456789012\nb -2\n");
  const auto answer = told(history, kStart + 20s);
  EXPECT_EQ(answer["seconds_ago"], nlohmann::json({20.0, 5.0}));
  EXPECT_EQ(answer["samples"]["a_total"], nlohmann::json({3.0, 123456789012.0}));
  EXPECT_EQ(answer["samples"]["b"], nlohmann::json({1.5, -2.0}));
  EXPECT_EQ(answer["interval_seconds"], MetricHistory::kInterval.count());
}

TEST(MetricHistory, TellsOfNothingInTheFuture) {
  MetricHistory history;
  history.take(kStart + 1s, "a 1\n");  // between whoever asks reading the clock, and asking
  EXPECT_EQ(told(history, kStart)["seconds_ago"], nlohmann::json({0.0}));
}

TEST(MetricHistory, HasNullWhereASeriesWasNotThere) {
  MetricHistory history;
  history.take(kStart, "early 1\n");
  history.take(kStart + 1s, "late{why=\"a, \\\"b\\\" {c}\"} 2\nodd NaN\n");
  const auto answer = told(history, kStart + 1s);
  EXPECT_EQ(answer["samples"]["early"], nlohmann::json({1.0, nullptr}));
  EXPECT_EQ(answer["samples"]["late{why=\"a, \\\"b\\\" {c}\"}"],
            nlohmann::json({nullptr, 2.0}));
  EXPECT_EQ(answer["samples"]["odd"], nlohmann::json({nullptr, nullptr}));
}

TEST(MetricHistory, ForgetsWhatIsOlderThanItKeeps) {
  MetricHistory history(60s);
  for (int i = 0; i <= 100; ++i) history.take(kStart + i * 15s, "n " + std::to_string(i));
  const auto answer = told(history, kStart + 1500s);
  EXPECT_EQ(answer["seconds_ago"], nlohmann::json({60.0, 45.0, 30.0, 15.0, 0.0}));
  EXPECT_EQ(answer["samples"]["n"], nlohmann::json({96.0, 97.0, 98.0, 99.0, 100.0}));
}

TEST(MetricHistory, TellsOfTheFamiliesThatAreAskedFor) {
  MetricHistory history;
  history.take(kStart, "a{x=\"1\"} 1\na{x=\"2\"} 2\nab 3\nc 4\n");
  EXPECT_EQ(told(history, kStart, "a,c")["samples"].size(), 3);
  EXPECT_EQ(told(history, kStart, "nothing")["samples"].size(), 0);
  EXPECT_EQ(told(history, kStart)["samples"].size(), 4);
}

TEST(MetricHistory, KeepsSoManySeriesAndSaysHowManyItLeftOut) {
  MetricHistory history(3600s, 2);
  history.take(kStart, "a 1\nb 2\nc 3\nd 4\n");
  const auto answer = told(history, kStart);
  EXPECT_EQ(answer["samples"].size(), 2);
  EXPECT_EQ(answer["left_out_series"], 2);
}

TEST(MetricHistory, IsToldAFewSeriesAtATime) {
  constexpr std::size_t kSeries = 100, kSamples = 240;
  MetricHistory history;
  for (std::size_t i = 0; i < kSamples; ++i) {
    std::string text;
    for (std::size_t s = 0; s < kSeries; ++s) text += "n" + std::to_string(s) + " 1.25\n";
    history.take(kStart + i * 1s, text);
  }
  MetricHistory::Telling telling = history.tell(kStart + 300s);
  history.take(kStart + 300s, "new 1");  // nothing of it is told
  std::string json;
  for (std::string piece = telling.next(); !piece.empty(); piece = telling.next()) {
    const auto numbers = std::ranges::count(piece, ',');
    EXPECT_LE(numbers, kSamples * (MetricHistory::Telling::kSeriesOfPiece + 1) + 2);
    json += piece;
  }
  const auto samples = nlohmann::json::parse(json)["samples"];
  ASSERT_EQ(samples.size(), kSeries);
  for (const auto& series : samples)
    EXPECT_EQ(series, nlohmann::json(std::vector<double>(kSamples, 1.25)));
}

TEST(MetricHistory, IsJsonWhateverSeriesAreCalled) {
  MetricHistory history;
  EXPECT_TRUE(told(history, kStart)["samples"].empty());
  history.take(kStart, "a{x=\"\xff\x01\"} 1\nb 1e300\nc -0.1\n");
  const auto answer = told(history, kStart);
  EXPECT_EQ(answer["samples"].size(), 3);
  EXPECT_EQ(answer["samples"]["b"], nlohmann::json({1e300}));
  EXPECT_EQ(answer["samples"]["c"], nlohmann::json({-0.1}));
}

TEST(MetricHistory, ReadsWhatTheMetricsWrite) {
  Metrics metrics;
  metrics.chunk_sent(1'000'000'007, 5);
  metrics.call_ended("StreamMesh", absl::StatusCode::kInternal, "", 0.25);
  MetricHistory history;
  history.take(kStart, metrics.text([] {
    return std::vector<Reading>{gauge("tetstream_free", "Some.", 2.5)};
  }));
  const auto samples = told(history, kStart)["samples"];
  EXPECT_EQ(samples["tetstream_sent_tets_total"], nlohmann::json({1e9 + 7}));
  EXPECT_EQ(samples["tetstream_free"], nlohmann::json({2.5}));
  EXPECT_EQ(samples["tetstream_refusals_total{code=\"INTERNAL\",reason=\"OTHER\"}"],
            nlohmann::json({1.0}));
  for (const auto& [series, values] : samples.items()) {
    EXPECT_EQ(series.find("_bucket"), std::string::npos) << series;
  }
}

}  // namespace
}  // namespace tet
