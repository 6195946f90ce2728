#include "server/http/listener_watch.h"

#include <atomic>
#include <cerrno>
#include <chrono>
#include <future>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "core/base/posix/packet_socket.h"
#include "tests/server/test_folder.h"
#include "tests/support/eventually.h"

namespace tet {
namespace {

using namespace std::chrono_literals;

/// A listener at which one connection waits that nobody takes, and what a loop makes of it.
class ListenerWatchTest : public testing::Test {
 protected:
  void run(Accepted always, std::chrono::milliseconds interval) {
    ASSERT_TRUE(listener_.is_open() && client_.is_open());
    loop_ = std::make_unique<EventLoop>(interval, [this] {
      ++ticks_;
      watch_->look_again();
    });
    watch_ = std::make_unique<ListenerWatch>(*loop_, listener_.number(), [this, always] {
      ++tried_;
      return always;
    });
    watch_->begin();
    loop_->start();
  }
  void TearDown() override {
    if (loop_ != nullptr) loop_->stop();
  }

  const test::TestFolder folder_;
  const Descriptor listener_ = listen_for_packets(folder_.file("socket"), 4);
  const Descriptor client_ = connect_for_packets(folder_.file("socket"));
  std::atomic<int> tried_{0}, ticks_{0};
  std::unique_ptr<EventLoop> loop_;
  std::unique_ptr<ListenerWatch> watch_;
};

TEST_F(ListenerWatchTest, LooksAgainAtTheNextTickWhereThereIsNoRoom) {
  run(Accepted::kNoRoom, 1ms);
  EXPECT_TRUE(test::eventually([&] { return ticks_ > 20 && tried_ > 1; }));
  loop_->stop();
  EXPECT_LE(tried_, ticks_ + 1);
}

TEST_F(ListenerWatchTest, LeavesOthersTheirTurnWhileConnectionsCome) {
  run(Accepted::kOne, 1h);
  std::promise<int> tried;
  loop_->post([&] { tried.set_value(tried_); });
  auto told = tried.get_future();
  ASSERT_EQ(told.wait_for(test::kGenerousEnd), std::future_status::ready);
  EXPECT_EQ(told.get() % ListenerWatch::kMostAtOnce, 0);
}

TEST(Accepted, TellsWhatLacksFromWhatIsGone) {
  for (const int lack : {EMFILE, ENFILE, ENOBUFS, ENOMEM}) {
    EXPECT_EQ(accepted_none(lack), Accepted::kNoRoom) << lack;
  }
  for (const int gone : {EAGAIN, ECONNABORTED, EINTR}) {
    EXPECT_EQ(accepted_none(gone), Accepted::kNone) << gone;
  }
}

}  // namespace
}  // namespace tet
