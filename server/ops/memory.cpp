#include "server/ops/memory.h"

#include <algorithm>
#include <bit>
#include <fstream>
#include <limits>
#include <optional>
#include <string>
#include <thread>
#include <unistd.h>
#include <vector>

#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_split.h>

namespace tet {

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMebibyte = std::uint64_t{1} << 20;

/// The program itself, gRPC and its connections, threads, and what the allocator does not give
/// back.
constexpr std::uint64_t kProcessBytes = 256 * kMebibyte;

/// Plans that are counted take up to so much for each byte of their limit: columns are held
/// twice while they grow, and so are lists of bricks while they are sorted.
constexpr std::uint64_t kCountingFactor = 2;

/// With less than this hardly anything can be meshed.
constexpr std::uint64_t kLeastBudget = 16 * kMebibyte;

/// A limit as a control group states it; nullopt where there is none.
std::optional<std::uint64_t> limit_in(const fs::path& file) {
  std::ifstream in(file);
  std::string text;
  std::uint64_t bytes = 0;
  if (!(in >> text) || !absl::SimpleAtoi(text, &bytes)) return std::nullopt;
  return bytes;
}

/// The least limit of a group and of those around it.
std::uint64_t least_limit(const fs::path& mount, const fs::path& group, const char* file) {
  std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
  fs::path at = mount;
  const auto look = [&] { least = std::min(least, limit_in(at / file).value_or(least)); };
  look();
  for (const fs::path& part : group.relative_path()) {
    at /= part;
    look();
  }
  return least;
}

std::uint64_t physical_memory() {
  return static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) *
         static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

std::uint64_t threads_of(const Config& config) {
  if (config.threads > 0) return config.threads;
  return std::max(1U, std::thread::hardware_concurrency());
}

std::uint64_t counting_bytes(const Config& config) {
  const std::uint64_t longest = std::min(kLongestPlanBytes, config.plan_bytes);
  return kCountingFactor * (threads_of(config) * std::min(kShortPlanBytes, longest) +
                            std::min(kLongerPlanBytes, longest) + kLongPlansAtOnce * longest);
}

std::uint64_t sum_of(const Config& config) {
  std::uint64_t sum = 0;
  for (const MemoryShare& share : memory_shares(config)) {
    sum += std::min(share.bytes, std::numeric_limits<std::uint64_t>::max() - sum);
  }
  return sum;
}

/// The largest value of a budget with which all fit; 0 if none does.
// NOLINTNEXTLINE(performance-unnecessary-value-param): the budget of the copy is set.
std::uint64_t largest_that_fits(Config config, std::uint64_t Config::*budget) {
  std::uint64_t fits = 0;
  for (std::uint64_t step = std::bit_floor(config.memory); step > 0; step /= 2) {
    config.*budget = fits + step;
    if (sum_of(config) <= config.memory) fits += step;
  }
  return fits;
}

absl::Status does_not_fit(const Config& config) {
  std::string shares;
  for (const MemoryShare& share : memory_shares(config)) {
    absl::StrAppend(&shares, shares.empty() ? "" : ", ",
                    (share.bytes + kMebibyte - 1) / kMebibyte, " MiB for ", share.what);
  }
  return absl::InvalidArgumentError(
      absl::StrCat("the budgets add up to ", sum_of(config), " bytes, and memory is ",
                   config.memory, ": ", shares,
                   ". Set a larger memory, smaller budgets (resident_bytes, plan_bytes, "
                   "send_bytes, receive_bytes), or fewer threads than ",
                   threads_of(config), ", each of which counts in memory of its own"));
}

}  // namespace

std::uint64_t allowed_memory(const fs::path& root) {
  std::uint64_t allowed = physical_memory();
  std::ifstream groups(root / "proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    const std::vector<std::string> parts = absl::StrSplit(line, absl::MaxSplits(':', 2));
    if (parts.size() != 3) continue;
    const fs::path mounts = root / "sys/fs/cgroup";
    if (parts[1].empty()) {
      allowed = std::min(allowed, least_limit(mounts, parts[2], "memory.max"));
    } else if (parts[1] == "memory") {
      allowed =
          std::min(allowed, least_limit(mounts / "memory", parts[2], "memory.limit_in_bytes"));
    }
  }
  return allowed;
}

std::vector<MemoryShare> memory_shares(const Config& config) {
  return {{"the process", kProcessBytes},
          {"grids (resident_bytes)", config.resident_bytes},
          {"grids that sessions change (half as much)", session_bytes(config)},
          {"counted meshes (plan_bytes)", config.plan_bytes},
          {"counting them", counting_bytes(config)},
          {"what is sent (send_bytes)", config.send_bytes + kIdleBlockBytes},
          {"what is received (receive_bytes)", config.receive_bytes},
          {"points that are sampled (half as much)", point_bytes(config)},
          {"the log (log_buffer_bytes)", config.log_buffer_bytes}};
}

absl::Status divide_memory(Config& config, std::uint64_t allowed) {
  if (config.memory == 0) config.memory = allowed;
  if (config.memory > allowed) {
    return absl::InvalidArgumentError(absl::StrCat("memory ", config.memory,
                                                   " is more than the machine or its control "
                                                   "group allows, ",
                                                   allowed));
  }
  const bool grids_are_open = config.resident_bytes == 0,
             plans_are_open = config.plan_bytes == 0;
  if (grids_are_open) config.resident_bytes = kLeastBudget;
  if (plans_are_open) config.plan_bytes = kLeastBudget;
  if (grids_are_open) {
    const std::uint64_t most = largest_that_fits(config, &Config::resident_bytes);
    // Plans take about half, if it is ours to say.
    config.resident_bytes = std::max(kLeastBudget, plans_are_open ? most / 2 : most);
  }
  if (plans_are_open) {
    config.plan_bytes = std::max(kLeastBudget, largest_that_fits(config, &Config::plan_bytes));
  }
  return sum_of(config) <= config.memory ? absl::OkStatus() : does_not_fit(config);
}

}  // namespace tet
