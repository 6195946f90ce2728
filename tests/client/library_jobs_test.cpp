// Jobs of the public library.
#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/client/library_fixture.h"

namespace tetstream {
namespace {

using test::BallSamples;
using test::expect_same;

class JobsOnAServer : public test::LibraryOnAServer {
 protected:
  Jobs jobs() const { return Jobs(client()); }
};

TEST_F(JobsOnAServer, AreSubmittedAwaitedAndFetched) {
  const Volume ball = BallSamples(24).volume();
  const Request request{.levels = 0};
  const Job job = jobs()
                      .submit(client().upload(ball).value(), request,
                              {.display_name = "a ball", .labels = {{"study", "one"}}})
                      .value();
  std::vector<double> told;
  const Job ended =
      jobs().wait(job.name, {.progress = [&](double share) { told.push_back(share); }}).value();
  EXPECT_EQ(ended.state, JobState::kSucceeded);
  EXPECT_TRUE(ended.error.ok());
  EXPECT_EQ(ended.order.labels, job.order.labels);
  EXPECT_TRUE(ended.created && ended.started && ended.finished);
  ASSERT_FALSE(told.empty());
  EXPECT_EQ(told.back(), 1);
  const Mesh here = mesh(ball, request).value();
  ASSERT_TRUE(ended.header);
  EXPECT_EQ(ended.header->tet_count, here.tet_count());
  expect_same(jobs().fetch(job.name).value(), here);
  MeshStream stream = jobs().stream(job.name, {}, {1, {}});
  ASSERT_NE(stream.next(), nullptr);
}

TEST_F(JobsOnAServer, AreListedByLabelsAndWatched) {
  const Scene scene = Scene::from_json(R"({"nodes": [{"sphere": {"radius": 1}}]})").value();
  std::vector<std::string> names;
  for (const char* const night : {"1", "2"}) {
    names.push_back(
        jobs().submit(scene, {.spacing = 0.2}, {.labels = {{"night", night}}}).value().name);
    ASSERT_TRUE(jobs().wait(names.back()).ok());
  }
  const JobList listed = jobs().list({.labels = {{"night", "2"}}}).value();
  ASSERT_EQ(listed.jobs.size(), 1U);
  EXPECT_EQ(listed.jobs.front().name, names.back());
  EXPECT_EQ(jobs().list({.most = 1}).value().jobs.size(), 1U);
  std::vector<JobChange> changes;
  const Status watched = jobs().watch(names.front(), 0, [&](const JobEvent& event) {
    changes.push_back(event.change);
    return !is_final(event.state);
  });
  EXPECT_TRUE(watched.ok()) << watched.to_string();
  EXPECT_EQ(changes.front(), JobChange::kCreated);
  EXPECT_EQ(changes.back(), JobChange::kFinished);
}

/// Jobs that nobody does: none is over before a test has come to it.
class JobsThatWait : public test::LibraryOnAServer {
 protected:
  JobsThatWait() : LibraryOnAServer(0) {}
  Jobs jobs() const { return Jobs(client()); }
};

TEST_F(JobsThatWait, AreCancelledRetriedAndRemoved) {
  const Scene ball = Scene::from_json(R"({"nodes": [{"sphere": {"radius": 1}}]})").value();
  const JobOrder order{.request_id = "one"};
  const std::string name = jobs().submit(ball, {.spacing = 0.004}, order).value().name;
  EXPECT_EQ(jobs().submit(ball, {.spacing = 0.004}, order).value().name, name);
  ASSERT_TRUE(jobs().cancel(name).ok());
  const Job cancelled = jobs().wait(name).value();
  EXPECT_EQ(cancelled.state, JobState::kCancelled);
  EXPECT_EQ(cancelled.error.reason(), "JOB_CANCELLED");
  EXPECT_EQ(jobs().fetch(name).status().reason(), "JOB_NOT_SUCCEEDED");
  EXPECT_FALSE(is_final(jobs().retry(name).value().state));
  EXPECT_EQ(jobs().remove(name).reason(), "JOB_ACTIVE");
  ASSERT_TRUE(jobs().cancel(name).ok());
  ASSERT_TRUE(jobs().wait(name).ok() && jobs().remove(name).ok());
  EXPECT_EQ(jobs().get(name).status().reason(), "JOB_NOT_FOUND");
}

}  // namespace
}  // namespace tetstream
