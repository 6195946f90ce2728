#include "core/vdb/decoder/decoder_pool.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <fstream>
#include <future>
#include <memory>
#include <string>
#include <unistd.h>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/core/vdb/decode_test_files.h"
#include "tests/core/vdb/hanging_decoder.h"

namespace tet {
namespace {

using namespace std::chrono_literals;

/// This process's children, of all its threads.
std::vector<pid_t> children() {
  std::vector<pid_t> pids;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    std::ifstream list(task.path() / "children");
    for (pid_t pid = 0; list >> pid;) pids.push_back(pid);
  }
  return pids;
}

class DecoderPoolTest : public test::DecodeTest {
 protected:
  static DecoderSettings settings(const std::string& program = "", int processes = 2) {
    return test::patient_settings(program, processes);
  }

  static std::future<absl::Status> ask(DecoderPool& pool,
                                       const FileRequest& request,
                                       std::function<bool()> cancelled = nullptr,
                                       const std::string& client = "client") {
    auto promise = std::make_shared<std::promise<absl::Status>>();
    pool.decode(client, request, std::move(cancelled),
                [promise, request](const absl::StatusOr<SealedBlock>& block) {
                  promise->set_value(volume_of(block, request).status());
                });
    return promise->get_future();
  }

  /// Kills every child that there is, once there are `count`.
  static void kill_children(std::size_t count) {
    ASSERT_TRUE(test::eventually([&] { return children().size() >= count; }));
    const std::vector<pid_t> killed = children();
    for (const pid_t pid : killed) ::kill(pid, SIGKILL);
    ASSERT_TRUE(test::eventually([&] { return std::ranges::all_of(killed, test::has_ended); }));
  }
};

TEST_F(DecoderPoolTest, DecodesManyFilesWithFewProcesses) {
  DecoderPool pool(settings());
  std::vector<std::future<absl::Status>> answers;
  for (int i = 0; i < 10; ++i) answers.push_back(ask(pool, request()));
  for (auto& answer : answers) EXPECT_TRUE(answer.get().ok());
  EXPECT_LE(children().size(), 4U);  // of each original a copy stands ready
}

TEST_F(DecoderPoolTest, GivesHealthyFilesTheirsWhileOthersCrash) {
  DecoderPool pool(settings(hostile("decode_but_for")));
  std::vector<std::future<absl::Status>> healthy, crashed;
  for (int i = 0; i < 20; ++i) {
    crashed.push_back(ask(pool, request("crash")));
    healthy.push_back(ask(pool, request()));
  }
  for (auto& answer : healthy) EXPECT_TRUE(answer.get().ok());
  for (auto& answer : crashed) EXPECT_EQ(failure_name(answer.get()), "DECODER_CRASHED");
}

TEST_F(DecoderPoolTest, ReplacesDecodersThatDieWhileTheyWait) {
  DecoderPool pool(settings());
  ASSERT_TRUE(ask(pool, request()).get().ok());
  for (int i = 0; i < 5; ++i) {
    kill_children(4);
    const absl::Status status = ask(pool, request()).get();
    EXPECT_TRUE(status.ok()) << status;
  }
}

TEST_F(DecoderPoolTest, KeepsItsDecoderWhenAFileIsRefusedWithoutIt) {
  DecoderPool pool(settings("", 1));
  FileRequest broken = request();
  broken.path = directory_.file("broken.vdb");
  std::ofstream(broken.path) << "no volume at all";
  ASSERT_TRUE(test::eventually([] { return children().size() >= 2; }));
  const std::vector<pid_t> before = children();
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(ask(pool, broken).get().ok());
  EXPECT_EQ(children(), before);
  EXPECT_TRUE(ask(pool, request()).get().ok());
  EXPECT_NE(children(), before);
}

TEST_F(DecoderPoolTest, TellsTheRequestWhoseDecoderIsKilledAtWork) {
  const std::string program = hostile("decode_but_for");
  DecoderPool pool(settings(program, 1));
  auto hanging = ask(pool, request("hang"));
  auto waiting = ask(pool, request());
  ASSERT_NE(test::hanging_decoder(program), 0);
  kill_children(2);
  const absl::Status killed = hanging.get();  // which is not the file's fault
  EXPECT_TRUE(absl::IsResourceExhausted(killed)) << killed;
  EXPECT_EQ(failure_name(killed), "DECODER_MEMORY");
  EXPECT_TRUE(waiting.get().ok());
}

TEST_F(DecoderPoolTest, ForgetsRequestsThatNobodyWantsAnyMore) {
  DecoderPool pool(settings(hostile("decode_but_for"), 1));
  std::atomic<bool> cancelled{false};
  auto hanging = ask(pool, request("hang"), [&] { return cancelled.load(); });
  auto queued = ask(pool, request("hang"), [&] { return cancelled.load(); });
  cancelled = true;
  EXPECT_TRUE(absl::IsCancelled(hanging.get()));
  EXPECT_TRUE(absl::IsCancelled(queued.get()));
}

TEST_F(DecoderPoolTest, LetsNobodyWaitForAllOfAnothersFiles) {
  const std::string program = hostile("decode_but_for");
  DecoderPool pool(settings(program, 1));
  std::atomic<bool> held{true};
  auto hanging = ask(
      pool, request("hang"), [&] { return !held; }, "greedy");
  ASSERT_NE(test::hanging_decoder(program), 0);  // so that all others wait
  std::vector<std::string> order;                // the pool's only thread adds to it
  std::vector<std::future<absl::Status>> answers;
  const auto note = [&](const std::string& client) {
    auto promise = std::make_shared<std::promise<absl::Status>>();
    answers.push_back(promise->get_future());
    pool.decode(client, request(), nullptr,
                [&order, client, promise](const absl::StatusOr<SealedBlock>& block) {
                  order.push_back(client);
                  promise->set_value(block.status());
                });
  };
  for (int i = 0; i < 5; ++i) note("greedy");
  note("modest");
  held = false;
  EXPECT_TRUE(absl::IsCancelled(hanging.get()));
  for (auto& answer : answers) EXPECT_TRUE(answer.get().ok());
  EXPECT_EQ(order.front(), "modest");
}

// A machine on which no decoder starts must not hold a thread for those who have gone.
TEST_F(DecoderPoolTest, AwaitsNoDecoderForWhoeverHasGone) {
  // The program, which never becomes ready, is there when the request is looked at.
  DecoderPool pool(settings(directory_.file("decoder.asleep"), 1));
  std::atomic<int> looks{0};
  const auto cancelled = [&] {
    constexpr int kPatience = 3;
    if (++looks == 1) hostile("asleep");
    return looks > kPatience;
  };
  const absl::Status status = ask(pool, request(), cancelled).get();
  EXPECT_TRUE(absl::IsCancelled(status)) << status;
}

TEST_F(DecoderPoolTest, EndsAtOnceWhateverRuns) {
  const std::string program = hostile("decode_but_for");
  auto pool = std::make_unique<DecoderPool>(settings(program, 1));
  auto hanging = ask(*pool, request("hang"));
  auto queued = ask(*pool, request());
  ASSERT_NE(test::hanging_decoder(program), 0);
  pool.reset();  // else it would be the time limit that ends it, and say so
  EXPECT_EQ(failure_name(hanging.get()), "SHUTTING_DOWN");
  EXPECT_EQ(failure_name(queued.get()), "SHUTTING_DOWN");
  EXPECT_TRUE(children().empty());
}

TEST_F(DecoderPoolTest, SaysThatThereIsNoProgram) {
  DecoderPool pool(settings("/no/such/program"));
  const absl::Status status = ask(pool, request()).get();
  EXPECT_TRUE(absl::IsUnavailable(status)) << status;
  EXPECT_EQ(failure_name(status), "DECODER_UNAVAILABLE");
}

}  // namespace
}  // namespace tet
