// Brackets around many zeros, narrowed together.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/stuffing/zero_bracket.h"

namespace tet {

/// Up to kCapacity brackets, those that are still open first. Each closes in on the very zero
/// that a ZeroBracket of its own would.
class ZeroBrackets {
 public:
  static constexpr std::size_t kCapacity = 128;

  /// Begins `count` brackets, given phi at both ends of each, of strictly opposite signs.
  void begin(const float* at_0, const float* at_1, std::size_t count) noexcept;

  std::size_t open() const noexcept { return open_; }
  /// Says of each one that is open which it was when they began.
  const std::uint16_t* which() const noexcept { return which_.data(); }
  /// Holds what each one that is open tries next.
  const double* next() const noexcept { return columns_.next.data(); }

  /// phi is `phi[i]` where the i-th that is open tried. The zeros of those that are done go to
  /// `zeros`, by which they were.
  void narrow(const double* phi, float* zeros) noexcept;

  /// Ends those that are still open: their zeros are as near as they are known.
  void end(float* zeros) noexcept;

  /// The members of ZeroBracket. `done` is as wide as they are: 0 or 1.
  struct Columns {
    using Column = std::array<double, kCapacity>;
    alignas(64) Column x, f, other, f_other, old, f_old, next;
    alignas(64) std::array<std::uint64_t, kCapacity> done;
  };

 private:
  void close_done(float* zeros) noexcept;
  float zero(std::size_t i) const noexcept;
  void move(std::size_t from, std::size_t to) noexcept;

  Columns columns_;
  std::array<std::uint16_t, kCapacity> which_;
  std::size_t open_ = 0;
};

}  // namespace tet
