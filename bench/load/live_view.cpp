#include "bench/load/live_view.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <unistd.h>
#include <utility>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "bench/load/quantiles.h"
#include "bench/load/units.h"

namespace tet::load {
namespace {

constexpr std::chrono::milliseconds kRedrawInterval{500};
constexpr std::chrono::seconds kLineInterval{5};
constexpr const char* kLinesUpAndErase = "\x1b[%dF\x1b[J";
/// A line that wraps would be two to erase.
constexpr const char* kWithoutWrapping = "\x1b[?7l%s\x1b[?7h";

bool stderr_is_a_terminal() {
  const char* terminal = std::getenv("TERM");
  return isatty(STDERR_FILENO) == 1 && terminal && std::string_view(terminal) != "dumb";
}

const char* name_of(LoadMoment::Phase phase) {
  switch (phase) {
    case LoadMoment::Phase::kWarmUp:
      return "warming up";
    case LoadMoment::Phase::kMeasuring:
      return "measuring";
    case LoadMoment::Phase::kDraining:
      return "waiting for the last answers";
  }
  return "";
}

/// A counter's growth from one moment to the next, a second.
struct Rates {
  Rates(const LoadMoment& previous, const LoadMoment& moment)
      : seconds(std::max(moment.seconds - previous.seconds, 1e-3)) {
    offered = static_cast<double>(moment.recent.offered) / seconds;
    done = static_cast<double>(moment.recent.done) / seconds;
    tets = static_cast<double>(moment.traffic.tets - previous.traffic.tets) / seconds;
    bytes = static_cast<double>(moment.traffic.bytes - previous.traffic.bytes) / seconds;
  }
  double seconds, offered, done, tets, bytes;
};

std::string latency_row(const std::string& name, const LatencyHistogram& latencies) {
  std::string row = absl::StrFormat("  %-16s", name);
  for (const Quantile& quantile : kQuantiles) {
    absl::StrAppendFormat(&row, " %9s", show_time(latencies.quantile(quantile.fraction)));
  }
  return absl::StrFormat("%s %9s\n", row, show_time(latencies.max()));
}

std::string latency_table(const LoadMoment& moment) {
  std::string text = absl::StrFormat("  %-16s", "latency");
  for (const Quantile& quantile : kQuantiles)
    absl::StrAppendFormat(&text, " %9s", quantile.name);
  absl::StrAppendFormat(&text, " %9s\n", "max");
  for (const LatencyKind kind : kLatencyKinds) {
    text += latency_row(tet::load::name_of(kind), moment.total.latency(kind));
  }
  return text + latency_row("whole, just now", moment.recent.latency(LatencyKind::kWhole));
}

std::string errors_line(const Tally& tally) {
  std::string text;
  for (const auto& [code, count] : tally.errors) {
    absl::StrAppend(&text, "  ", absl::StatusCodeToString(code), " ", count);
  }
  return text.empty() ? "  none" : text;
}

}  // namespace

std::string live_screen(const std::string& title,
                        const LoadMoment& previous,
                        const LoadMoment& moment) {
  const Rates rates(previous, moment);
  std::string text = absl::StrFormat("%s\n  %s, %.0f of %.0f s", title, name_of(moment.phase),
                                     moment.seconds, moment.total_seconds);
  if (moment.rate_per_second > 0) {
    absl::StrAppend(&text, ", asked for ", show_number(moment.rate_per_second), "/s");
  }
  absl::StrAppend(&text, "\n  requests   ", show_number(rates.offered), "/s offered, ",
                  show_number(rates.done), "/s done, ", moment.outstanding, " outstanding, ",
                  moment.queued, " queued, ", moment.total.dropped, " dropped\n");
  absl::StrAppend(&text, "  received   ", show_number(rates.tets), " tets/s, ",
                  show_number(rates.bytes), "B/s\n");
  absl::StrAppend(&text, latency_table(moment), "  errors   ", errors_line(moment.total), "\n");
  return text;
}

std::string live_line(const LoadMoment& previous, const LoadMoment& moment) {
  const Rates rates(previous, moment);
  const LatencyHistogram whole = moment.recent.latency(LatencyKind::kWhole);
  std::string text = absl::StrFormat(
      "%5.1f s %s: %s/s offered, %s/s done, %d outstanding, %d queued, %s tets/s, p50 %s, p99 "
      "%s",
      moment.seconds, name_of(moment.phase), show_number(rates.offered),
      show_number(rates.done), moment.outstanding, moment.queued, show_number(rates.tets),
      show_time(whole.quantile(0.5)), show_time(whole.quantile(0.99)));
  if (!moment.recent.errors.empty()) {
    absl::StrAppend(&text, ", errors:", errors_line(moment.recent));
  }
  return text;
}

LiveView::LiveView(std::string title, bool quiet)
    : title_(std::move(title)), quiet_(quiet), terminal_(stderr_is_a_terminal()) {}

LiveView::~LiveView() { erase(); }

LoadWatch LiveView::watch() {
  if (quiet_) return {};
  return {terminal_ ? Nanoseconds{kRedrawInterval} : Nanoseconds{kLineInterval},
          [this](const LoadMoment& moment) { draw(moment); }};
}

void LiveView::draw(const LoadMoment& moment) {
  if (terminal_) {
    const std::string screen = live_screen(title_, previous_, moment);
    erase();
    std::fprintf(stderr, kWithoutWrapping, screen.c_str());
    lines_drawn_ = static_cast<int>(std::ranges::count(screen, '\n'));
  } else {
    std::fprintf(stderr, "%s\n", live_line(previous_, moment).c_str());
  }
  previous_ = moment;
}

void LiveView::erase() {
  if (lines_drawn_ > 0) std::fprintf(stderr, kLinesUpAndErase, lines_drawn_);
  lines_drawn_ = 0;
}

}  // namespace tet::load
