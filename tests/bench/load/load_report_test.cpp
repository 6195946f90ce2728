#include "bench/load/load_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "bench/load/live_view.h"
#include "bench/load/verdict.h"

namespace tet::load {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;
using namespace std::chrono_literals;

/// 98 meshes that took 1 to 98 ms, one refused and one given up after 5 s.
Tally sample_tally() {
  Tally tally;
  LoadRequest request;
  request.intended = TimePoint{} + 1h;
  Outcome outcome;
  for (int ms = 1; ms <= 98; ++ms) {
    const Nanoseconds whole = std::chrono::milliseconds(ms);
    outcome.header = request.intended + whole / 4;
    outcome.first_chunk = request.intended + whole / 2;
    outcome.ended = request.intended + whole;
    tally.add_done(request, outcome);
    tally.lateness.add(50us);
  }
  tally.add_failed(absl::ResourceExhaustedError("64 meshes are being made"));
  Outcome never;
  never.ended = request.intended + 5s;
  tally.add_unfinished(request, never);
  tally.offered = 100;
  return tally;
}

LoadResult sample_result() {
  LoadResult result;
  result.plan.steps = {{10, 5}, {20, 5}};
  result.total = sample_tally();
  result.steps = {sample_tally(), Tally{}};
  result.entries = {sample_tally()};
  result.window = {10, {20'000'000, 300'000'000}, 2.5};
  return result;
}

LoadSetting sample_setting() {
  MixEntry entry;
  entry.label = "bunny.vdb --levels 0";
  entry.message.set_levels(0);
  entry.tet_count = 1234567;
  return {"127.0.0.1:7447", "2026-11-21T12:00:00+00:00", {entry}, {*parse_goal("p99=200ms")}};
}

TEST(Tally, CountsWhateverDidNotComeInTimeAsMissed) {
  const Tally tally = sample_tally();
  EXPECT_EQ(tally.missed(*parse_goal("p99=200ms")), 2u);
  EXPECT_EQ(tally.missed(*parse_goal("p99=90ms")), 10u);
  EXPECT_EQ(tally.missed(*parse_goal("first-chunk-p99=45ms")), 10u);
  EXPECT_FALSE(tally.holds(*parse_goal("p99=200ms")));
  EXPECT_TRUE(tally.holds(*parse_goal("p98=200ms")));
  EXPECT_TRUE(tally.holds(*parse_goal("p90=90ms")));
  EXPECT_FALSE(tally.holds(*parse_goal("p91=90ms")));
}

TEST(Tally, HoldsNothingWithoutRequests) { EXPECT_FALSE(Tally{}.holds(*parse_goal("p50=1s"))); }

TEST(Verdict, TellsWhoWasInTheWay) {
  const std::vector<LatencyGoal> goals{*parse_goal("p90=50ms")};
  LoadResult result = sample_result();
  EXPECT_EQ(judge(result, goals), Verdict::kMissed);
  EXPECT_EQ(judge(result, std::vector{*parse_goal("p90=1s")}), Verdict::kHeld);

  result.total.errors[absl::StatusCode::kResourceExhausted] = 30;
  result.total.failed = 30;
  EXPECT_EQ(judge(result, goals), Verdict::kRefused);
  result.total.errors = {{absl::StatusCode::kDataLoss, 30}};
  EXPECT_EQ(judge(result, goals), Verdict::kFailed);

  result = sample_result();
  for (int i = 0; i < 10; ++i) result.total.lateness.add(10ms);
  EXPECT_EQ(judge(result, goals), Verdict::kGenerator);
  result = sample_result();
  result.window.generator_cpu_seconds = 1e6;
  EXPECT_EQ(judge(result, goals), Verdict::kGenerator);

  result.interrupted = true;
  EXPECT_EQ(judge(result, goals), Verdict::kInterrupted);
}

TEST(Verdict, WarnsOfEverythingThatBendsTheFigures) {
  LoadResult result = sample_result();
  result.total.queued = 7;
  result.total.dropped = 8;
  result.total.lateness.add(2s);
  result.total.lateness.add(2s);
  result.interrupted = true;
  const auto warnings = warnings_of(result, sample_setting().goals);
  std::string text;
  for (const std::string& warning : warnings) text += warning + "\n";
  for (const char* part :
       {"signal", "7 requests waited", "8 requests were dropped", "1 requests were given up",
        "1 requests failed", "may be the bottleneck", "p99 of 100 requests"}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
  EXPECT_EQ(warnings.size(), 7u);
}

TEST(ReportJson, HasTheDocumentedKeys) {
  const json report = json::parse(report_json(sample_setting(), sample_result()));
  EXPECT_EQ(report["schema"], 1);
  EXPECT_EQ(report["server"], "127.0.0.1:7447");
  EXPECT_EQ(report["encoding"], "plain");
  EXPECT_EQ(report["mix"][0]["label"], "bunny.vdb --levels 0");
  EXPECT_EQ(report["mix"][0]["tets"], 1234567);
  EXPECT_EQ(report["plan"]["mode"], "open");
  EXPECT_EQ(report["plan"]["steps"][1]["per_second"], 20);
  EXPECT_EQ(report["requests"]["offered"], 100);
  EXPECT_EQ(report["requests"]["done"], 98);
  EXPECT_EQ(report["errors"]["RESOURCE_EXHAUSTED"]["count"], 1);
  EXPECT_NEAR(report["latency_ms"]["whole"]["p50"].get<double>(), 50, 0.1);
  EXPECT_NEAR(report["latency_ms"]["header"]["p90"].get<double>(), 22.5, 0.5);
  EXPECT_NEAR(report["latency_ms"]["whole"]["max"].get<double>(), 5000, 1e-6);
  EXPECT_EQ(report["latency_ms"]["whole"]["count"], 99);
  EXPECT_DOUBLE_EQ(report["rates"]["tets_s"], 2e6);
  EXPECT_DOUBLE_EQ(report["rates"]["bytes_s"], 3e7);
  EXPECT_DOUBLE_EQ(report["generator"]["cores_used"], 0.25);
  EXPECT_EQ(report["targets"][0]["held"], false);
  EXPECT_EQ(report["by_step"].size(), 2u);
  EXPECT_EQ(report["by_request"][0]["label"], "bunny.vdb --levels 0");
  EXPECT_EQ(report["interrupted"], false);
}

TEST(ReportJson, SurvivesTextThatIsNotUtf8) {
  LoadSetting setting = sample_setting();
  setting.mix[0].label = "\xff.vdb";
  EXPECT_TRUE(json::accept(report_json(setting, sample_result())));
}

TEST(ReportText, ShowsCountsLatenciesErrorsPartsAndNotes) {
  const std::string text = report_text(sample_setting(), sample_result());
  for (const char* part :
       {"Poisson arrivals at 10/s to 20/s in 2 steps, 10 s after 3 s of warm-up",
        "bunny.vdb --levels 0: 1.23M tets", "100 offered (10/s), 98 done, 1 failed",
        "2M tets/s, 30MB/s", "p99.9", "first chunk", "RESOURCE_EXHAUSTED 1: 64 meshes",
        "target       p99=200ms NOT held: 2 of 100", "note: 1 requests were given up"}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
}

SearchResult sample_search() {
  SearchResult search;
  search.per_second = 40;
  search.failed_per_second = 42;
  search.limited_by = Verdict::kRefused;
  search.trials = 3;
  search.held = 2;
  search.requests = 1200;
  search.missed = 6;
  search.missed_share = wilson_interval(6, 1200);
  search.all = {{40, Verdict::kHeld, 400, 2}, {42, Verdict::kRefused, 420, 9}};
  return search;
}

TEST(SearchReport, SaysTheRateTheTrialsTheConfidenceAndWhatLimitsIt) {
  const std::string text =
      search_text(sample_setting(), {sample_search(), sample_result(), std::nullopt});
  for (const char* part : {"40/s holds p99=200ms", "2 of 3 trials held",
                           "6 of 1200 requests missed (0.50 %; 95 % confidence 0.23 to 1.09 %)",
                           "42/s does not: the server refused requests",
                           "one request at a time took 50 ms (p50 of 99)"}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
  const json report = json::parse(
      search_json(sample_setting(), {sample_search(), std::nullopt, sample_result()}));
  EXPECT_EQ(report["search"]["per_second"], 40);
  EXPECT_EQ(report["search"]["limited_by"], "refused");
  EXPECT_EQ(report["trials"][1]["verdict"], "refused");
  EXPECT_EQ(report["best"]["requests"]["offered"], 100);
  EXPECT_TRUE(report["alone"].is_null());
}

TEST(LiveView, ShowsTheMomentOnOneScreen) {
  LoadMoment before, now;
  before.seconds = 4;
  now.phase = LoadMoment::Phase::kMeasuring;
  now.seconds = 6;
  now.total_seconds = 33;
  now.rate_per_second = 50;
  now.outstanding = 12;
  now.queued = 3;
  now.traffic = {8'000'000, 100'000'000};
  now.total = sample_tally();
  now.recent = sample_tally();
  const std::string screen = live_screen("tetstream-load", before, now);
  for (const char* part : {"measuring, 6 of 33 s, asked for 50/s", "50/s offered, 49/s done",
                           "12 outstanding, 3 queued", "4M tets/s, 50MB/s", "first chunk",
                           "RESOURCE_EXHAUSTED 1"}) {
    EXPECT_THAT(screen, HasSubstr(part));
  }
  EXPECT_LE(std::ranges::count(screen, '\n'), 24);
  const std::string line = live_line(before, now);
  EXPECT_THAT(line, HasSubstr("50/s offered, 49/s done, 12 outstanding"));
  EXPECT_THAT(line, Not(HasSubstr("\n")));
}

}  // namespace
}  // namespace tet::load
