#include "server/ops/memory.h"

#include <filesystem>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/test_folder.h"

namespace tet {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

constexpr std::uint64_t kGiB = std::uint64_t{1} << 30;

std::uint64_t sum_of(const Config& config) {
  std::uint64_t sum = 0;
  for (const MemoryShare& share : memory_shares(config)) sum += share.bytes;
  return sum;
}

TEST(Memory, IsDividedSoThatAllFit) {
  for (const std::uint64_t allowed : {kGiB, 4 * kGiB, 16 * kGiB, 256 * kGiB}) {
    Config config;
    config.threads = 2;
    ASSERT_EQ(divide_memory(config, allowed), absl::OkStatus()) << allowed;
    EXPECT_EQ(config.memory, allowed);
    EXPECT_LE(sum_of(config), allowed);
    EXPECT_GE(sum_of(config), allowed - allowed / 8) << "little is left unused";
    EXPECT_GE(config.resident_bytes, allowed / 16);
    EXPECT_GE(config.plan_bytes, allowed / 64);
  }
}

TEST(Memory, LeavesWhatIsSetAsItIs) {
  Config config;
  config.memory = 4 * kGiB;
  config.resident_bytes = kGiB;
  ASSERT_EQ(divide_memory(config, 16 * kGiB), absl::OkStatus());
  EXPECT_EQ(config.memory, 4 * kGiB);
  EXPECT_EQ(config.resident_bytes, kGiB);
  EXPECT_GT(config.plan_bytes, 0U);
  EXPECT_LE(sum_of(config), 4 * kGiB);
}

TEST(Memory, RefusesASumThatCannotFitAndNamesItsParts) {
  Config config;
  config.resident_bytes = 2 * kGiB;
  config.plan_bytes = 8 * kGiB;
  EXPECT_THAT(
      std::string(divide_memory(config, 4 * kGiB).message()),
      AllOf(HasSubstr("memory is 4294967296"), HasSubstr("2048 MiB for grids (resident_bytes)"),
            HasSubstr("8192 MiB for counted meshes (plan_bytes)")));
}

TEST(Memory, TellsThatItIsTheThreadsWhichDoNotFit) {
  Config config;
  config.threads = 128;  // of a large machine, whose control group has 4 GiB
  EXPECT_THAT(std::string(divide_memory(config, 4 * kGiB).message()),
              HasSubstr("or fewer threads than 128"));
}

TEST(Memory, RefusesLessThanAServerTakesAndMoreThanThereIs) {
  Config small, large;
  EXPECT_FALSE(divide_memory(small, kGiB / 4).ok());
  large.memory = 5 * kGiB;
  EXPECT_THAT(std::string(divide_memory(large, 4 * kGiB).message()),
              HasSubstr("memory 5368709120 is more than"));
}

TEST(Memory, OverflowsNowhere) {
  Config config;
  config.resident_bytes = config.plan_bytes = kMaxSetting;
  config.send_bytes = kMaxSetting;
  EXPECT_FALSE(divide_memory(config, kMaxSetting).ok());
}

TEST(Memory, IsWhatTheGroupsAroundTheProcessLeave) {
  const test::TestFolder folder;
  const auto write = [&](const std::string& path, const std::string& text) {
    fs::create_directories(fs::path(folder.file(path)).parent_path());
    folder.write(path, text);
  };
  const std::string root = folder.file("");
  const std::uint64_t machine = allowed_memory(root);
  EXPECT_GT(machine, 0U);
  write("proc/self/cgroup", "0::/outer/inner\n");
  write("sys/fs/cgroup/outer/inner/memory.max", "max\n");
  EXPECT_EQ(allowed_memory(root), machine);
  write("sys/fs/cgroup/outer/memory.max", "65536\n");
  EXPECT_EQ(allowed_memory(root), 65536U);
  write("proc/self/cgroup", "3:cpu:/x\n4:memory:/old\n");
  write("sys/fs/cgroup/memory/old/memory.limit_in_bytes", "4096\n");
  EXPECT_EQ(allowed_memory(root), 4096U);
}

}  // namespace
}  // namespace tet
