#include "core/base/posix/wake_event.h"

#include <poll.h>
#include <thread>

#include <gtest/gtest.h>

namespace tet {
namespace {

bool is_set(const WakeEvent& event, int patience_ms = 0) {
  pollfd source{event.number(), POLLIN, 0};
  return ::poll(&source, 1, patience_ms) > 0;
}

TEST(WakeEventTest, IsSetUntilItIsReset) {
  WakeEvent event;
  EXPECT_FALSE(is_set(event));
  event.set();
  event.set();
  EXPECT_TRUE(is_set(event));
  EXPECT_TRUE(is_set(event));
  event.reset();
  EXPECT_FALSE(is_set(event));
  event.reset();  // which does not wait
}

TEST(WakeEventTest, EndsAnotherThreadsPoll) {
  WakeEvent event;
  std::thread other([&] { event.set(); });
  EXPECT_TRUE(is_set(event, -1));
  other.join();
}

}  // namespace
}  // namespace tet
