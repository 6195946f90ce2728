#include <algorithm>
#include <cmath>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_join.h>

#include "bench/load/load_report.h"
#include "bench/load/quantiles.h"
#include "bench/load/units.h"
#include "bench/load/verdict.h"

namespace tet::load {
namespace {

std::string show_rate(double per_second) { return show_number(per_second) + "/s"; }

std::string heading(const LoadSetting& setting, const LoadPlan& plan) {
  std::string text = absl::StrFormat("%s: %s%s\n", setting.server, describe_plan(plan),
                                     setting.encoding == v1::ENCODING_PLAIN
                                         ? ""
                                         : absl::StrCat(", ", encoding_name(setting.encoding)));
  for (const MixEntry& entry : setting.mix) {
    const std::string often =
        setting.mix.size() > 1 ? absl::StrFormat(" (weight %g)", entry.weight) : "";
    absl::StrAppend(&text, "  ", entry.label, often, ": ",
                    show_number(static_cast<double>(entry.tet_count)), " tets\n");
  }
  return text;
}

std::string counts_text(const LoadResult& result) {
  const Tally& total = result.total;
  const double seconds = std::max(result.window.seconds, 1e-9);
  std::string text = absl::StrFormat(
      "requests     %d offered (%s), %d done, %d failed, %d unfinished, %d dropped\n",
      total.offered, show_rate(static_cast<double>(total.offered) / seconds), total.done,
      total.failed, total.unfinished, total.dropped);
  absl::StrAppend(&text, "received     ",
                  show_number(static_cast<double>(result.window.received.tets) / seconds),
                  " tets/s, ",
                  show_number(static_cast<double>(result.window.received.bytes) / seconds),
                  "B/s, in ", absl::StrFormat("%.1f s\n", result.window.seconds));
  return text;
}

std::string quantile_row(const std::string& name, const LatencyHistogram& latencies) {
  std::string row = absl::StrFormat("%-12s", name);
  for (const Quantile& quantile : kQuantiles) {
    absl::StrAppendFormat(&row, " %9s", show_time(latencies.quantile(quantile.fraction)));
  }
  return absl::StrFormat("%s %9s\n", row, show_time(latencies.max()));
}

std::string quantile_titles(const std::string& first) {
  std::string row = absl::StrFormat("%-12s", first);
  for (const Quantile& quantile : kQuantiles)
    absl::StrAppendFormat(&row, " %9s", quantile.name);
  return absl::StrFormat("%s %9s\n", row, "max");
}

std::string latencies_text(const LoadResult& result) {
  std::string text = quantile_titles("latency");
  for (const LatencyKind kind : kLatencyKinds) {
    absl::StrAppend(&text, quantile_row(name_of(kind), result.total.latency(kind)));
  }
  return absl::StrCat(text, quantile_row("sent late", result.total.lateness));
}

std::string errors_text(const Tally& tally) {
  std::string text;
  for (const auto& [code, count] : tally.errors) {
    absl::StrAppend(&text, "error        ", absl::StatusCodeToString(code), " ", count, ": ",
                    tally.error_messages.at(code), "\n");
  }
  return text;
}

std::string part_row(const std::string& name, const Tally& tally) {
  const LatencyHistogram whole = tally.latency(LatencyKind::kWhole);
  return absl::StrFormat("  %-28s %8d %8d %8d %9s %9s %9s\n", name, tally.offered, tally.done,
                         tally.failed + tally.unfinished + tally.dropped,
                         show_time(whole.quantile(0.5)), show_time(whole.quantile(0.99)),
                         show_time(whole.max()));
}

std::string part_titles(const std::string& name) {
  return absl::StrFormat("%-30s %8s %8s %8s %9s %9s %9s\n", name, "offered", "done", "not done",
                         "p50", "p99", "max");
}

/// By step and by entry, where there are several.
std::string parts_text(const LoadSetting& setting, const LoadResult& result) {
  std::string text;
  if (result.steps.size() > 1) text += part_titles("step");
  for (std::size_t i = 0; result.steps.size() > 1 && i < result.steps.size(); ++i) {
    text += part_row(show_rate(result.plan.steps[i].per_second), result.steps[i]);
  }
  if (result.entries.size() > 1) text += part_titles("request");
  for (std::size_t i = 0; result.entries.size() > 1 && i < result.entries.size(); ++i) {
    text += part_row(setting.mix[i].label, result.entries[i]);
  }
  return text;
}

std::string goals_text(const LoadSetting& setting, const LoadResult& result) {
  std::string text;
  for (const LatencyGoal& goal : setting.goals) {
    absl::StrAppendFormat(&text, "target       %s %s: %d of %d requests missed it\n",
                          show_goal(goal), result.total.holds(goal) ? "held" : "NOT held",
                          result.total.missed(goal), result.total.offered);
  }
  return text;
}

std::string warnings_text(const LoadSetting& setting, const LoadResult& result) {
  std::string text;
  for (const std::string& warning : warnings_of(result, setting.goals)) {
    absl::StrAppend(&text, "note: ", warning, "\n");
  }
  return text;
}

const char* explain(Verdict verdict) {
  switch (verdict) {
    case Verdict::kMissed:
      return "the answers came too late";
    case Verdict::kRefused:
      return "the server refused requests (see its max_streams)";
    case Verdict::kFailed:
      return "requests failed";
    case Verdict::kGenerator:
      return "this program could not keep up, so the server may well do more; run it on a "
             "machine of its own";
    default:
      return "the search was ended there";
  }
}

std::string answer_text(const LoadSetting& setting, const SearchResult& search) {
  const std::string goals =
      absl::StrJoin(setting.goals, ", ",
                    [](std::string* out, const LatencyGoal& goal) { *out += show_goal(goal); });
  std::string text;
  if (!search.per_second) {
    text = absl::StrFormat("no rate was found that holds %s\n", goals);
  } else {
    text = absl::StrFormat("%s holds %s\n", show_rate(*search.per_second), goals);
    absl::StrAppendFormat(
        &text,
        "  %d of %d trials held; %d of %d requests missed (%.2f %%; 95 %% confidence "
        "%.2f to %.2f %%)\n",
        search.held, search.trials, search.missed, search.requests,
        100 * static_cast<double>(search.missed) /
            static_cast<double>(std::max(search.requests, std::uint64_t{1})),
        100 * search.missed_share.low, 100 * search.missed_share.high);
  }
  if (search.failed_per_second) {
    absl::StrAppendFormat(&text, "  %s does not: %s\n", show_rate(*search.failed_per_second),
                          explain(search.limited_by));
  }
  if (search.interrupted)
    text += "  ended early by a signal: the answer is what was known then\n";
  return text;
}

}  // namespace

std::string encoding_name(v1::Encoding encoding) {
  if (encoding == v1::ENCODING_COMPACT) return "compact";
  return encoding == v1::ENCODING_PACKED ? "packed" : "plain";
}

std::string describe_plan(const LoadPlan& plan) {
  const double seconds = RateProfile(plan.steps).seconds();
  const std::string times =
      absl::StrFormat(", %.3g s after %.3g s of warm-up", seconds, plan.warm_up_seconds);
  if (plan.workers > 0) {
    return absl::StrCat(plan.workers, plan.workers == 1 ? " worker" : " workers",
                        " back to back", times);
  }
  const std::string process = absl::StrCat(
      plan.process == ArrivalProcess::kPoisson ? "Poisson arrivals " : "even arrivals ",
      plan.burst > 1 ? absl::StrCat("of ", plan.burst, " at once ") : "", "at ");
  const std::string first = show_rate(plan.steps.front().per_second);
  if (plan.steps.size() == 1) return absl::StrCat(process, first, times);
  return absl::StrCat(process, first, " to ", show_rate(plan.steps.back().per_second), " in ",
                      plan.steps.size(), " steps", times);
}

std::string report_text(const LoadSetting& setting, const LoadResult& result) {
  return absl::StrCat(heading(setting, result.plan), counts_text(result),
                      latencies_text(result), errors_text(result.total),
                      parts_text(setting, result), goals_text(setting, result),
                      warnings_text(setting, result));
}

std::string search_text(const LoadSetting& setting, const LoadSearch& found) {
  std::string text = answer_text(setting, found.search);
  if (found.alone) {
    const LatencyHistogram whole = found.alone->total.latency(LatencyKind::kWhole);
    absl::StrAppendFormat(&text, "  one request at a time took %s (p50 of %d)\n",
                          show_time(whole.quantile(0.5)), whole.count());
  }
  if (!found.best) return text;
  return absl::StrCat(text, "one of the trials at that rate:\n",
                      report_text(setting, *found.best));
}

std::string trial_line(const Trial& trial) {
  return absl::StrFormat("%10s  %-10s %d of %d requests missed", show_rate(trial.per_second),
                         name_of(trial.verdict), trial.missed, trial.requests);
}

}  // namespace tet::load
