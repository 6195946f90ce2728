// Scattering the bits of a number.
#pragma once

#include <cstdint>

namespace tet {

/// A bijection of 64 bits without visible pattern (splitmix64's finaliser).
inline std::uint64_t mix_bits(std::uint64_t x) noexcept {
  x += 0x9e3779b97f4a7c15U;
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31U);
}

}  // namespace tet
