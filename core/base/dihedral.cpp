#include "core/base/dihedral.h"

#include <numbers>

namespace tet {
namespace {

constexpr double kDegPerRad = 180 / std::numbers::pi;

}  // namespace

double signed_square_of_cosine(double degrees) noexcept {
  const double cosine = degrees == 90 ? 0 : std::cos(degrees / kDegPerRad);
  return cosine * std::abs(cosine);
}

double degrees_of(double signed_square) noexcept {
  return std::acos(std::copysign(std::sqrt(std::abs(signed_square)), signed_square)) *
         kDegPerRad;
}

}  // namespace tet
