#include "server/grids/verify.h"

#include <cstdint>
#include <filesystem>
#include <future>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/parallel.h"
#include "proto/convert/status.h"
#include "proto/wire/sha256.h"
#include "tests/support/test_directory.h"

namespace tet {
namespace {

/// Several turns of zeros, which take no disk.
constexpr std::uint64_t kManyTurns = std::uint64_t{100} << 20;

class VerifyTest : public testing::Test {
 protected:
  /// A stored file of that name.
  std::string stored(const std::string& name, std::uint64_t size) {
    const std::string path = directory_.file(name);
    test::write_bytes(path, "");
    std::filesystem::resize_file(path, size);
    return path;
  }

  /// Keeps the only thread until `posted` has been called, so that what it posts comes to wait
  /// in the order in which it does.
  template <class Posted>
  void hold_while(const Posted& posted) {
    std::promise<void> all_posted;
    disk_.post("holder", [&, ready = all_posted.get_future().share()] { ready.wait(); });
    posted();
    all_posted.set_value();
  }

  absl::Status verify(const std::string& path) {
    std::promise<absl::Status> told;
    verify_in_turns({disk_, "client", [] { return false; }}, path,
                    [&](const absl::Status& status) { told.set_value(status); });
    return told.get_future().get();
  }

  test::TestDirectory directory_;
  FairTasks disk_{pool_};
  TaskPool pool_{1};  // ends first: a task is charged once it is done
};

TEST_F(VerifyTest, TellsWhatAFileIsWhetherInTurnsOrNot) {
  Sha256 digest;
  digest.add(std::string(kManyTurns, '\0'));
  const std::string intact = stored(digest.finish_hex(), kManyTurns);
  const std::string damaged = stored(std::string(64, 'a'), 1000);
  const std::string gone = directory_.file(std::string(64, 'b'));
  EXPECT_EQ(verify(intact), absl::OkStatus());
  EXPECT_EQ(verify_stored(intact), absl::OkStatus());
  for (const std::string& path : {damaged, gone}) {
    EXPECT_TRUE(absl::IsDataLoss(verify(path))) << path;
    EXPECT_EQ(verify(path), verify_stored(path));
  }
}

TEST_F(VerifyTest, LeavesTurnsToOthers) {
  const std::string path = stored(std::string(64, 'a'), kManyTurns);
  std::vector<std::string> order;
  std::promise<void> done;
  hold_while([&] {
    verify_in_turns({disk_, "client", [] { return false; }}, path, [&](const absl::Status&) {
      order.push_back("verified");
      done.set_value();
    });
    disk_.post("other", [&] { order.push_back("other"); });
  });
  done.get_future().wait();
  EXPECT_EQ(order, (std::vector<std::string>{"other", "verified"}));
}

TEST_F(VerifyTest, EndsWhenNobodyWantsToKnow) {
  const std::string path = stored(std::string(64, 'a'), std::uint64_t{1} << 40);
  std::promise<absl::Status> told;
  bool cancelled = false;  // on the pool's thread alone
  hold_while([&] {
    verify_in_turns({disk_, "client", [&] { return cancelled; }}, path,
                    [&](const absl::Status& status) { told.set_value(status); });
    disk_.post("other", [&] { cancelled = true; });
  });
  EXPECT_TRUE(absl::IsCancelled(told.get_future().get()));
}

}  // namespace
}  // namespace tet
