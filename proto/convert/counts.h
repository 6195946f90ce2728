// Numbers of messages that may be hostile, as core has them.
#pragma once

#include <cstdint>

namespace tet {

/// This is beyond any mesh that fits a machine, and small enough that sizes in bytes do not
/// overflow.
inline constexpr std::int64_t kMaxCount = std::int64_t{1} << 48;

constexpr bool is_count(std::int64_t count) { return 0 <= count && count <= kMaxCount; }
constexpr bool is_count(std::uint64_t count) { return count <= std::uint64_t{kMaxCount}; }

/// For a count that was checked.
constexpr std::uint64_t unsigned_count(std::int64_t count) {
  return static_cast<std::uint64_t>(count);
}
/// For a count that core made.
constexpr std::int64_t signed_count(std::uint64_t count) {
  return static_cast<std::int64_t>(count);
}

}  // namespace tet
