// Where long work stands.
#pragma once

#include <atomic>
#include <cstdint>

namespace tet {

/// Readable from any thread while the work is done.
struct MeshProgress {
  std::atomic<std::uint64_t> done{0}, total{0};  ///< bricks surveyed, and bricks to survey

  /// Tells that so many more are to be surveyed, if that was not known already. One survey
  /// comes after the other.
  void expect(std::uint64_t bricks) noexcept {
    const std::uint64_t all = done + bricks;
    if (total < all) total = all;
  }
};

}  // namespace tet
