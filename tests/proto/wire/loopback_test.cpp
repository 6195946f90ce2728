#include "proto/wire/loopback.h"

#include <gtest/gtest.h>

namespace tet {
namespace {

TEST(Loopback, IsWhatNeverLeavesTheMachine) {
  for (const char* address : {"127.0.0.1:7447", "127.9.8.7:1", "localhost:7447", "[::1]:7447",
                              "unix:/run/tetstream.sock"}) {
    EXPECT_TRUE(is_loopback(address)) << address;
  }
}

TEST(Loopback, IsNotWhatOnlyLooksLikeIt) {
  for (const char* address : {"0.0.0.0:7447", "[::]:7447", "10.0.0.1:7447",
                              "127.0.0.1.example:7447", "127.1:7447", "localhost.example:7447",
                              "dns:///localhost:7447", "[::ffff:10.0.0.1]:1", "mesher", ""}) {
    EXPECT_FALSE(is_loopback(address)) << address;
  }
}

}  // namespace
}  // namespace tet
