// When requests are due: decided by a clock and a seed before anything is sent, so that slow
// answers cannot thin out the questions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

namespace tet::load {

/// A number in [0, 1) that depends on the generator's state alone, unlike the standard
/// library's distributions.
double uniform_number(std::mt19937_64& random);

/// A constant rate for a while.
struct RateStep {
  double per_second = 0;  ///< requests; positive
  double seconds = 0;     ///< positive
};

/// How many requests are expected by when.
class RateProfile {
 public:
  explicit RateProfile(std::vector<RateStep> steps);

  const std::vector<RateStep>& steps() const { return steps_; }
  double seconds() const { return seconds_; }
  double expected_requests() const { return requests_; }

  /// When `requests` of them are expected to have come: the inverse of the integrated rate,
  /// seconds after the start. Beyond expected_requests() it goes on at the last step's rate.
  double time_of(double requests) const;

  std::size_t step_at(double seconds) const;

 private:
  std::vector<RateStep> steps_;
  double seconds_ = 0, requests_ = 0;
};

enum class ArrivalProcess : std::uint8_t {
  kConstant,  ///< evenly spaced
  kPoisson,   ///< independent of each other, as many callers are
};

/// One request's intended start.
struct Arrival {
  double seconds = 0;  ///< after the start of the profile
  std::size_t step = 0;
};

/// The arrivals of a profile, in order. The same seed gives the same ones.
///
/// Both processes run at rate 1 and are then stretched by the profile (time rescaling), which
/// leaves a Poisson process Poisson under any rate. With a burst of n, n requests arrive at
/// once wherever one would, and a n-th as often.
class Arrivals {
 public:
  Arrivals(RateProfile profile,
           ArrivalProcess process,
           std::uint64_t seed,
           std::size_t burst = 1);

  /// The next arrival; std::nullopt once the profile is over.
  std::optional<Arrival> next();

 private:
  RateProfile profile_;
  ArrivalProcess process_;
  std::mt19937_64 random_;
  std::size_t burst_, in_burst_ = 0;
  double requests_ = 0;  ///< where the process of rate 1 is
};

}  // namespace tet::load
