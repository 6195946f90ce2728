// Random numbers that are the same on every machine.
#pragma once

#include <cstdint>

#include "core/base/mix_bits.h"

namespace tet::test {

/// A sequence that depends on `seed` and `stream` alone.
class RandomBits {
 public:
  RandomBits(std::uint64_t seed, std::uint64_t stream)
      : state_(mix_bits(seed ^ mix_bits(stream + 1))) {}

  std::uint64_t next() noexcept { return mix_bits(state_++); }

  /// Evenly in [0, count); 0 when count is.
  std::uint64_t below(std::uint64_t count) noexcept { return count == 0 ? 0 : next() % count; }

 private:
  std::uint64_t state_;
};

}  // namespace tet::test
