// Where phi is zero on a line.
#pragma once

#include <cmath>
#include <optional>
#include <utility>

namespace tet {

/// How far zeros are looked for, and what is close enough; in units of the line's parameter.
struct ZeroSearch {
  double reach = 0, close = 0;
};

/// The parameter, near 0, where `phi_at(t)` is zero: a few secants, of which the first is as
/// steep as `steepness` says. Nothing where they lead beyond reach, or nowhere.
template <class PhiAt>
std::optional<double> zero_along(const PhiAt& phi_at,
                                 double steepness,
                                 const ZeroSearch& search) noexcept {
  constexpr int kSteps = 6;
  double before = 0, phi_before = phi_at(0.0);
  if (phi_before == 0) return 0;
  double t = -phi_before / steepness;
  for (int step = 0; step < kSteps; ++step) {
    if (!(std::abs(t) <= search.reach)) return std::nullopt;
    if (std::abs(t - before) <= search.close) return t;
    const double phi = phi_at(t);
    if (phi == 0) return t;
    const double next = t - phi * (t - before) / (phi - phi_before);
    before = std::exchange(t, next);
    phi_before = phi;
  }
  // What creases make slow is still good where it hardly moves.
  const bool is_near =
      std::abs(t) <= search.reach && std::abs(t - before) <= 1e3 * search.close;
  return is_near ? std::optional(t) : std::nullopt;
}

}  // namespace tet
