// Jobs that are followed by a server that breaks off, and whose jobs go.
#include "client/command/job/follow_jobs.h"

#include <chrono>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/client/played_jobs.h"

namespace tet::test {
namespace {

constexpr RetryPolicy kThrice{
    .attempts = 3, .attempts_once_known = 3, .first_backoff_ms = 1, .max_backoff_ms = 1};
constexpr const char* kName = "jobs/019310c2a5d84f6b8e7a2c11";

v1::JobEvent event_of(v1::JobState state, std::int64_t revision) {
  v1::JobEvent event;
  event.set_name(kName);
  event.set_state(state);
  event.set_revision(revision);
  return event;
}

class FollowJobsTest : public testing::Test {
 protected:
  /// How a watch of the played jobs ends that is told one change at its seventh attempt, by a
  /// clock of which each look takes so long.
  absl::Status watch_by(std::chrono::seconds a_look) {
    jobs_.watch = [](int call, const PlayedJobs::Tell& tell) {
      if (call < 7) return absl::UnavailableError("cut off");
      tell(event_of(v1::JOB_STATE_RUNNING, 1));
      return absl::OkStatus();
    };
    std::chrono::steady_clock::time_point now{};
    JobClient client(jobs_.connect(kThrice), [&] { return now += a_look; });
    return client.watch(
        "", 0, [](const v1::JobEvent&) { return false; }, never_);
  }

  PlayedJobs jobs_;
  Cancellation never_;
};

TEST_F(FollowJobsTest, GoOnWatchingThroughManyCutsThatEachComeLate) {
  EXPECT_EQ(watch_by(std::chrono::seconds(60)), absl::OkStatus());
  EXPECT_EQ(jobs_.watches(), 7);
}

TEST_F(FollowJobsTest, GiveUpAServerThatCutsEachWatchAtOnce) {
  EXPECT_TRUE(absl::IsUnavailable(watch_by(std::chrono::seconds(1))));
  EXPECT_EQ(jobs_.watches(), kThrice.attempts);
}

TEST_F(FollowJobsTest, GiveUpAServerThatHangsBehindAProxyHoweverLongThatWaits) {
  jobs_.begins_watches = false;
  EXPECT_TRUE(absl::IsUnavailable(watch_by(std::chrono::seconds(60))));
  EXPECT_EQ(jobs_.watches(), kThrice.attempts);
}

TEST_F(FollowJobsTest, TakeUpAWatchMoreOftenOnceItsServerHasAnswered) {
  jobs_.watch = [](int, const PlayedJobs::Tell&) { return absl::UnavailableError("gone"); };
  RetryPolicy policy = kThrice;
  policy.attempts_once_known = 5;
  JobClient client(jobs_.connect(policy),
                   [] { return std::chrono::steady_clock::time_point{}; });
  const auto attempts = [&](bool answers) {
    jobs_.begins_watches = answers;
    const int before = jobs_.watches();
    const absl::Status ended = client.watch(
        "", 0, [](const v1::JobEvent&) { return true; }, never_);
    EXPECT_TRUE(absl::IsUnavailable(ended)) << ended;
    return jobs_.watches() - before;
  };
  EXPECT_EQ(attempts(/*answers=*/false), 3);
  EXPECT_EQ(attempts(/*answers=*/true), 5);
}

TEST_F(FollowJobsTest, TellOfAJobThatWasDeletedBeforeItWasReadByItsName) {
  jobs_.get = [](int call, const std::string& name, v1::Job& job) {
    if (call > 1) return with_reason(absl::NotFoundError("no such job"), "JOB_NOT_FOUND");
    job.set_name(name);
    job.set_state(v1::JOB_STATE_RUNNING);
    return absl::OkStatus();
  };
  jobs_.watch = [](int, const PlayedJobs::Tell& tell) {
    tell(event_of(v1::JOB_STATE_SUCCEEDED, 1));
    return absl::OkStatus();
  };
  std::vector<v1::Job> finished;
  const FollowWatch watch{[&](const v1::Job& job) { finished.push_back(job); }, [](double) {}};
  JobClient client(jobs_.connect(kThrice));
  EXPECT_EQ(follow_jobs(client, {kName}, watch, never_), absl::OkStatus());
  ASSERT_EQ(finished.size(), 1U);
  EXPECT_EQ(finished[0].name(), kName);
  EXPECT_EQ(finished[0].state(), v1::JOB_STATE_UNSPECIFIED);
}

TEST_F(FollowJobsTest, RefuseAJobThatTheServerNeverHad) {
  jobs_.get = [](int, const std::string&, v1::Job&) {
    return with_reason(absl::NotFoundError("no such job"), "JOB_NOT_FOUND");
  };
  const FollowWatch watch{[](const v1::Job&) {}, [](double) {}};
  JobClient client(jobs_.connect(kThrice));
  EXPECT_TRUE(absl::IsNotFound(follow_jobs(client, {kName}, watch, never_)));
}

}  // namespace
}  // namespace tet::test
