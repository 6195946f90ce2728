// Jobs of a namespace beside those of another, which take long to count.
#include <gtest/gtest.h>

#include "tests/server/job_server.h"
#include "tests/server/token_book.h"
#include "tests/support/eventually.h"

namespace tet::test {
namespace {

class JobNeighboursTest : public testing::Test {
 protected:
  JobNeighboursTest() {
    for (const char* name : {"greedy", "modest"}) tokens_.add(name, kScopes, name);
    server_.start(
        {"--tokens", tokens_.file(), "--job-workers", "2", "--job-count-bricks", kWhole});
  }

  /// A job of whoever is greedy, once it is being counted.
  v1::Job slow_job(double finer) {
    v1::Job job = server_.slow_to_count();
    job.mutable_mesh()->set_spacing(job.mesh().spacing() * finer);
    const v1::Job created = server_.create(job);
    EXPECT_TRUE(eventually([&] { return state_of(created) == v1::JOB_STATE_RUNNING; }));
    return created;
  }

  v1::JobState state_of(const v1::Job& job) { return server_.get(job).state(); }

  static constexpr char kScopes[] =
      "\"grids.read\", \"grids.write\", \"mesh\", \"jobs.read\", \"jobs.write\"";
  static constexpr char kWhole[] = "8388608";  // no count is divided
  JobServer server_{TETSTREAMD_PATH};
  TokenBook tokens_{server_.folder};
};

TEST_F(JobNeighboursTest, ASmallJobIsDoneBesideThoseThatTakeLongToCount) {
  server_.use_token("secret-of-greedy");
  std::vector<v1::Job> slow;
  for (const double finer : {1.0, 0.99, 0.98, 0.97, 0.96}) {
    if (slow.size() < 2) {
      slow.push_back(slow_job(finer));
    } else {
      v1::Job more = slow[0];
      more.mutable_mesh()->set_spacing(more.mesh().spacing() * finer);
      slow.push_back(server_.create(more));  // as many as a worker claims ahead, and more
    }
  }
  server_.use_token("secret-of-modest");
  const v1::Job small = server_.create(server_.ball(8));
  EXPECT_EQ(server_.wait(small).state(), v1::JOB_STATE_SUCCEEDED);
  server_.use_token("secret-of-greedy");
  EXPECT_EQ(state_of(slow[0]), v1::JOB_STATE_RUNNING);
  EXPECT_EQ(state_of(slow[1]), v1::JOB_STATE_RUNNING);
  for (const v1::Job& job : slow) server_.cancel(job);
}

}  // namespace
}  // namespace tet::test
