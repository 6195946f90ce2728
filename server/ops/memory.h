// How much memory a process may take, and what of it each budget has.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <vector>

#include <absl/status/status.h>

#include "server/ops/config.h"

namespace tet {

/// What plans may take while they are counted, in turns of each kind: see PlanTurns. Short ones
/// are as many at once as there are threads.
inline constexpr std::uint64_t kShortPlanBytes = std::uint64_t{32} << 20;
inline constexpr std::uint64_t kLongerPlanBytes = std::uint64_t{256} << 20;
inline constexpr std::uint64_t kLongestPlanBytes = std::uint64_t{4} << 30;
inline constexpr std::uint64_t kLongPlansAtOnce = 2;

/// Blocks of chunks that wait to be used again.
inline constexpr std::uint64_t kIdleBlockBytes = std::uint64_t{32} << 20;

/// Grids that sessions have changed may take this much together, beside those of files.
constexpr std::uint64_t session_bytes(const Config& config) {
  return config.resident_bytes / 2;
}

/// Points that calls sample may take this much together: what one message may bring, at least.
constexpr std::uint64_t point_bytes(const Config& config) {
  return std::max(config.receive_bytes / 2, config.max_request_bytes);
}

/// Returns what the machine has, or what the control groups that this process is in leave it,
/// if that is less. `root` is another one in tests only.
std::uint64_t allowed_memory(const std::filesystem::path& root = "/");

/// Something that takes memory, and how much at most.
struct MemoryShare {
  const char* what = nullptr;
  std::uint64_t bytes = 0;
};

/// Everything that a process with these settings keeps; none of its budgets is 0.
std::vector<MemoryShare> memory_shares(const Config& config);

/// Gives those budgets their sizes that the settings leave open (0): `memory` is what is
/// allowed, `resident_bytes` and `plan_bytes` are parts of it.
/// Errors: kInvalidArgument (they cannot all be had at once; the message has each of them).
absl::Status divide_memory(Config& config, std::uint64_t allowed = allowed_memory());

}  // namespace tet
