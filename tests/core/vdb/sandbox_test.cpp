// What a decoder can no longer do; not in builds with a sanitizer, which keep no sandbox.
#include "core/vdb/decoder/sandbox.h"

#include <atomic>
#include <chrono>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/vdb/decoder/idle_threads.h"
#include "tests/core/vdb/decode_test_files.h"
#include "tests/support/eventually.h"

namespace tet {
namespace {

using testing::HasSubstr;

class SandboxTest : public test::DecodeTest {};

TEST_F(SandboxTest, KillsWhoeverDoesMoreThanDecode) {
  for (const char* deed : {"open", "accomplice", "socket", "exec", "fork", "thread", "kill",
                           "execute", "map", "limits"}) {
    const absl::Status status = outcome(deed);
    EXPECT_EQ(failure_name(status), "DECODER_CRASHED") << deed;
    EXPECT_THAT(std::string(status.message()), HasSubstr("signal 31")) << deed;  // SIGSYS
  }
}

TEST_F(SandboxTest, LetsThreadsThatAreStillStartingComeToRest) {
  EXPECT_EQ(outcome("starting"), absl::OkStatus());
}

TEST(IdleThreads, AreAwaitedUntilAllSleep) {
  std::atomic<bool> working = true, over = false;
  std::thread busy([&] {
    while (working) continue;
    over.wait(false);
  });
  std::thread looking([&] {
    EXPECT_EQ(await_idle_threads(), absl::OkStatus());
    EXPECT_FALSE(working);
    over = true;
    over.notify_all();
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(50));  // for it to look at the busy one
  working = false;
  looking.join();
  busy.join();
}

TEST_F(SandboxTest, EndsWhatGrows) {
  EXPECT_EQ(failure_name(outcome("grow")), "DECODER_CRASHED");  // nobody caught std::bad_alloc
  const absl::Status full = outcome("fill");
  EXPECT_EQ(failure_name(full), "DECODER_MEMORY") << full;
}

TEST_F(SandboxTest, EndsWhatSpins) {
  DecoderSettings settings = test::patient_settings(hostile("spin"));
  settings.max_time = std::chrono::milliseconds(200);
  const absl::Status status = decode_once(request(), settings, nullptr).status();
  EXPECT_EQ(failure_name(status), "DECODER_TIMEOUT") << status;
}

TEST_F(SandboxTest, TellsThatWhatSpinsHadItsTimeOfAProcessor) {
  absl::StatusOr<CheckedFile> checked = check_request(request(), test::kGenerousEnd);
  ASSERT_TRUE(checked.ok()) << checked.status();
  checked->order.limits.cpu_seconds = 1;
  absl::StatusOr<Decoder> decoder = Decoder::start(test::patient_program(hostile("spin")));
  ASSERT_TRUE(decoder.ok()) << decoder.status();
  ASSERT_EQ(decoder->wait_until_ready(nullptr), absl::OkStatus());
  const absl::Status status =
      decoder->decode(checked->order, checked->file.number(), {test::kGenerousEnd, nullptr})
          .status();
  EXPECT_EQ(failure_name(status), "DECODER_TIMEOUT") << status;
  EXPECT_THAT(std::string(status.message()), HasSubstr("more than 1 s of processor time"));
}

}  // namespace
}  // namespace tet
