#include "bench/load/arrivals.h"

#include <cmath>
#include <utility>

namespace tet::load {

double uniform_number(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11) * 0x1p-53;  // a double holds 53 bits
}

RateProfile::RateProfile(std::vector<RateStep> steps) : steps_(std::move(steps)) {
  for (const RateStep& step : steps_) {
    seconds_ += step.seconds;
    requests_ += step.per_second * step.seconds;
  }
}

double RateProfile::time_of(double requests) const {
  double start = 0;
  for (const RateStep& step : steps_) {
    const double in_step = step.per_second * step.seconds;
    if (requests < in_step) return start + requests / step.per_second;
    requests -= in_step;
    start += step.seconds;
  }
  return start + requests / steps_.back().per_second;
}

std::size_t RateProfile::step_at(double seconds) const {
  std::size_t step = 0;
  for (double end = steps_[0].seconds; step + 1 < steps_.size() && seconds >= end;) {
    end += steps_[++step].seconds;
  }
  return step;
}

Arrivals::Arrivals(RateProfile profile,
                   ArrivalProcess process,
                   std::uint64_t seed,
                   std::size_t burst)
    : profile_(std::move(profile)), process_(process), random_(seed), burst_(burst) {}

std::optional<Arrival> Arrivals::next() {
  // An exponential gap before each, or an even one after each, so that both begin at once.
  const auto gap = static_cast<double>(burst_);
  const bool poisson = process_ == ArrivalProcess::kPoisson;
  if (poisson && in_burst_ == 0) requests_ -= gap * std::log1p(-uniform_number(random_));
  if (requests_ >= profile_.expected_requests()) return std::nullopt;
  const double seconds = profile_.time_of(requests_);
  in_burst_ = (in_burst_ + 1) % burst_;
  if (!poisson && in_burst_ == 0) requests_ += gap;
  return Arrival{seconds, profile_.step_at(seconds)};
}

}  // namespace tet::load
