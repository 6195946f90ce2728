// Times and rates as people write and read them.
#pragma once

#include <string>
#include <vector>

#include <absl/status/statusor.h>
#include <absl/strings/string_view.h>

#include "bench/load/load_clock.h"

namespace tet::load {

/// A service that keeps its goals at this rate is not meshing; and offering more than that
/// would take longer than it is to last.
inline constexpr double kMaxPerSecond = 1e6;

/// "200ms", "50us", "1.5s", "2m", or a plain number of seconds; not negative.
/// Errors: kInvalidArgument, naming the text.
absl::StatusOr<Nanoseconds> parse_time(absl::string_view text);

/// Requests a second: "5", steps "5,10,20", or "10:100:10", ten equal steps from 10 to 100.
/// Errors: kInvalidArgument (not such a text, a rate that is not positive or over
/// kMaxPerSecond, over 10000 steps).
absl::StatusOr<std::vector<double>> parse_rates(absl::string_view text);

std::string show_time(Nanoseconds time);  ///< "12.3 ms", three digits
std::string show_number(double number);   ///< "1.23M", three digits

}  // namespace tet::load
