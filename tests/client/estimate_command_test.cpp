// `tetstream estimate` that is stopped.
#include <algorithm>
#include <atomic>
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <gtest/gtest.h>

#include "client/command/command.h"
#include "tests/support/test_directory.h"

namespace tet::test {
namespace {

class EstimateCommandTest : public testing::Test {
 protected:
  EstimateCommandTest() {
    std::ofstream(scene_) << R"({"nodes": [{"name": "ball", "sphere": {"radius": 1}}]})";
  }

  struct End {
    absl::Status status;
    std::int64_t looks = 0;
  };
  /// How the command ends where its interruption comes with this look at it.
  End estimate_until(std::int64_t last_look) const {
    CLI::App app;
    const Command command = add_estimate_command(app);
    std::vector<std::string> words{scene_, "--spacing", "0.2", "--threads", "1"};
    std::reverse(words.begin(), words.end());  // as CLI11 takes them
    app.parse(words);
    std::atomic<std::int64_t> looks{0};
    const Cancellation interruption(Cancellation::Clock::time_point::max(),
                                    [&] { return ++looks >= last_look; });
    const absl::Status status = command(interruption);
    return {status, looks.load()};
  }

  const TestDirectory folder_;
  const std::string scene_ = folder_.file("ball.json");
};

/// However late it comes: a figure of what was counted until then would be wrong.
TEST_F(EstimateCommandTest, TellsNothingOnceItIsInterrupted) {
  const End whole = estimate_until(1'000'000'000);
  ASSERT_TRUE(whole.status.ok()) << whole.status;
  for (std::int64_t early = 0; early < 8; ++early) {
    const std::int64_t last = whole.looks - early;
    const End end = estimate_until(last);
    if (end.looks >= last) {
      EXPECT_TRUE(absl::IsCancelled(end.status)) << early << ": " << end.status;
    }
  }
}

}  // namespace
}  // namespace tet::test
