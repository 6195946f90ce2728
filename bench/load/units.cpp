#include "bench/load/units.h"

#include <array>
#include <cmath>
#include <cstddef>

#include <absl/strings/match.h>
#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_split.h>
#include <absl/strings/strip.h>

namespace tet::load {
namespace {

constexpr double kMaxSeconds = 1e7;  // four months: in nanoseconds far from overflow
constexpr std::size_t kMaxSteps = 10000;

struct Unit {
  absl::string_view name;
  double seconds;
};
/// A unit that another ends with comes after it.
constexpr std::array kUnits{Unit{"ns", 1e-9}, Unit{"us", 1e-6}, Unit{"ms", 1e-3},
                            Unit{"s", 1},     Unit{"m", 60},    Unit{"h", 3600}};

absl::Status not_a_rate(absl::string_view text) {
  return absl::InvalidArgumentError(
      absl::StrCat("\"", text, "\" is not a rate: give 5, or 5,10,20, or 10:100:10"));
}

absl::StatusOr<double> parse_rate(absl::string_view text) {
  double rate = 0;
  if (!absl::SimpleAtod(text, &rate) || !std::isfinite(rate)) return not_a_rate(text);
  if (rate > kMaxPerSecond) {
    return absl::InvalidArgumentError(
        absl::StrFormat("rate %s is over %.0f a second", text, kMaxPerSecond));
  }
  if (rate > 0) return rate;
  return absl::InvalidArgumentError(absl::StrCat("rate ", text, " is not positive"));
}

/// FROM:TO:STEPS
absl::StatusOr<std::vector<double>> parse_ramp(absl::string_view text) {
  const std::vector<absl::string_view> parts = absl::StrSplit(text, ':');
  std::size_t steps = 0;
  if (parts.size() != 3 || !absl::SimpleAtoi(parts[2], &steps) || steps < 2) {
    return not_a_rate(text);
  }
  if (steps > kMaxSteps) {
    return absl::InvalidArgumentError(absl::StrCat(steps, " steps are over ", kMaxSteps));
  }
  const auto first = parse_rate(parts[0]), last = parse_rate(parts[1]);
  if (!first.ok()) return first.status();
  if (!last.ok()) return last.status();
  std::vector<double> rates;
  for (std::size_t i = 0; i < steps; ++i) {
    rates.push_back(
        std::lerp(*first, *last, static_cast<double>(i) / static_cast<double>(steps - 1)));
  }
  return rates;
}

}  // namespace

absl::StatusOr<Nanoseconds> parse_time(absl::string_view text) {
  absl::string_view number = text;
  double unit_seconds = 1;
  for (const Unit& unit : kUnits) {
    if (!absl::ConsumeSuffix(&number, unit.name)) continue;
    unit_seconds = unit.seconds;
    break;
  }
  double count = 0;
  if (!absl::SimpleAtod(number, &count) || !(count * unit_seconds >= 0) ||
      count * unit_seconds > kMaxSeconds) {
    return absl::InvalidArgumentError(
        absl::StrCat("\"", text, "\" is not a time: give 200ms, 10s or 2m"));
  }
  return from_seconds(count * unit_seconds);
}

absl::StatusOr<std::vector<double>> parse_rates(absl::string_view text) {
  if (absl::StrContains(text, ':')) return parse_ramp(text);
  std::vector<double> rates;
  for (const absl::string_view part : absl::StrSplit(text, ',')) {
    const absl::StatusOr<double> rate = parse_rate(part);
    if (!rate.ok()) return rate.status();
    rates.push_back(*rate);
  }
  return rates;
}

std::string show_time(Nanoseconds time) {
  const double seconds = to_seconds(time);
  if (seconds == 0) return "0 s";
  if (seconds < 1e-3) return absl::StrFormat("%.3g us", seconds * 1e6);
  if (seconds < 1) return absl::StrFormat("%.3g ms", seconds * 1e3);
  return seconds < 1000 ? absl::StrFormat("%.3g s", seconds)
                        : absl::StrFormat("%.0f s", seconds);
}

std::string show_number(double number) {
  for (const char* suffix : {"", "k", "M"}) {
    if (number < 999.5) return absl::StrFormat("%.3g%s", number, suffix);
    number /= 1000;
  }
  return number < 999.5 ? absl::StrFormat("%.3gG", number) : absl::StrFormat("%.0fG", number);
}

}  // namespace tet::load
