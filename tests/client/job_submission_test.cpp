#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <sys/resource.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/command/job/journal.h"
#include "client/command/job/manifest.h"
#include "tests/server/test_folder.h"

namespace tet {
namespace {

using testing::HasSubstr;

constexpr const char* kServer = "farm:7447";

std::vector<JobOrder> orders_of(const std::string& manifest,
                                const JobArguments& defaults = {}) {
  std::istringstream lines(manifest);
  const auto jobs = read_manifest(lines, "jobs.txt", defaults);
  EXPECT_TRUE(jobs.ok()) << jobs.status();
  std::vector<JobOrder> orders;
  for (const JobArguments& job : *jobs) orders.push_back(*understand_job(job));
  return orders;
}

TEST(Manifest, ReadsTheSameJobOfALineAndOfAnObject) {
  const auto orders = orders_of(
      "'a b.vdb' --levels 0 --label x=1 --box -1 -1 -1 1 1 1 --preset both-sides --manifold\n"
      "# between\n\n"
      R"({"box": [-1, -1, -1, 1, 1, 1], "input": "a b.vdb", "label": {"x": 1}, "levels": 0,)"
      R"( "manifold": true, "improve": false, "preset": "both-sides", "name": null})");
  ASSERT_EQ(orders.size(), 2);
  EXPECT_EQ(digest_of(orders[0]), digest_of(orders[1]));
  EXPECT_EQ(orders[0].job.display_name(), "a b");
}

TEST(Manifest, TakesWhatALineDoesNotSayFromTheDefaults) {
  JobArguments defaults;
  defaults.priority = 7;
  defaults.labels = {"night=monday", "part=none"};
  const auto orders = orders_of("a.vdb --label part=ear\nb.vdb --priority 1\n", defaults);
  ASSERT_EQ(orders.size(), 2);
  EXPECT_EQ(orders[0].job.priority(), 7);
  EXPECT_EQ(orders[0].job.labels().at("part"), "ear");
  EXPECT_EQ(orders[0].job.labels().at("night"), "monday");
  EXPECT_EQ(orders[1].job.priority(), 1);
  EXPECT_EQ(orders[1].job.labels().at("part"), "none");
}

/// What a program writes for "nothing" must not take the next option for its value.
TEST(Manifest, RefusesAValueThatIsEmpty) {
  for (const std::string& key : std::vector<std::string>{
           "name", "ttl", "timeout", "grid", "sizing", "preset", "labels", "inside", "improve",
           "iso", "label", "field", "box", "coordinates", "voxel"}) {
    for (const std::string& line :
         {R"({"input": "a.vdb", ")" + key + R"(": "", "levels": 0})",
          R"({"input": "a.vdb", ")" + key + R"(": [""], "levels": 0})",
          R"({"input": "a.vdb", ")" + key + R"(": ["", 1], "levels": 0})",
          "a.vdb --" + key + "= --levels 0"}) {
      std::istringstream lines(line);
      const absl::Status status = read_manifest(lines, "jobs.txt", {}).status();
      EXPECT_THAT(std::string(status.message()),
                  HasSubstr("jobs.txt:1: --" + key + ": it is empty"))
          << line;
    }
  }
}

TEST(Manifest, TakesAnEmptyListAndAnEmptyValueOfALabel) {
  const auto orders = orders_of(R"({"input": "a.vdb", "field": [], "label": {"part": ""}})");
  ASSERT_EQ(orders.size(), 1);
  EXPECT_EQ(orders[0].job.labels().at("part"), "");
  EXPECT_EQ(orders[0].job.mesh().fields_size(), 0);
}

TEST(JobOrder, IsToldFromOthersByAllThatItAsksFor) {
  const auto orders = orders_of(
      "a.vdb\nb.vdb\na.vdb --iso 0.1\na.vdb --priority 1\na.vdb --label a=b\na.vdb "
      "--skip-cache\n"
      "a.vdb --ttl 1h\na.vdb --timeout 1h\na.stl\na.stl --voxel 0.1\n");
  for (std::size_t i = 0; i < orders.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) EXPECT_NE(digest_of(orders[i]), digest_of(orders[j]));
  }
}

class JournalTest : public testing::Test {
 protected:
  std::unique_ptr<Journal> open() {
    auto journal = Journal::open(path_, kServer);
    EXPECT_TRUE(journal.ok()) << journal.status();
    return journal.ok() ? *std::move(journal) : nullptr;
  }

  test::TestFolder folder_;
  const std::string path_ = folder_.file("journal.jsonl");
};

TEST_F(JournalTest, GivesAnOrderTheSameRequestIdForEver) {
  const std::string id = open()->request_id("order", 0);
  EXPECT_EQ(id.size(), 40);
  EXPECT_EQ(open()->request_id("order", 0), id);
  EXPECT_NE(open()->request_id("order", 1), id);
  EXPECT_NE(open()->request_id("another", 0), id);
  std::filesystem::remove(path_);
  EXPECT_NE(open()->request_id("order", 0), id);
}

TEST_F(JournalTest, KnowsTheJobsThatWereRecordedToTheEndOfTheirLine) {
  {
    const auto journal = open();
    ASSERT_TRUE(journal->record("one", "jobs/1").ok());
    ASSERT_TRUE(journal->record("two", "jobs/2").ok());
  }
  std::filesystem::resize_file(path_, std::filesystem::file_size(path_) - 1);
  const auto journal = open();
  EXPECT_EQ(journal->job_of("one"), "jobs/1");
  EXPECT_EQ(journal->job_of("two"), std::nullopt);
  ASSERT_TRUE(journal->record("three", "jobs/3").ok());
  EXPECT_EQ(*jobs_of_journal(path_), (std::vector<std::string>{"jobs/1", "jobs/3"}));
}

/// Lets files of this process grow no further than this, as a disk that is full does.
class SizeLimit {
 public:
  explicit SizeLimit(std::uint64_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~SizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  SizeLimit(const SizeLimit&) = delete;
  SizeLimit& operator=(const SizeLimit&) = delete;

 private:
  void (*const handler_)(int);
  rlimit before_{};
};

TEST_F(JournalTest, TakesAwayWhatAFullDiskTookOfALine) {
  {
    const auto journal = open();
    ASSERT_TRUE(journal->record("one", "jobs/1").ok());
    const std::uint64_t whole = std::filesystem::file_size(path_);
    {
      const SizeLimit limit(whole + 10);
      EXPECT_FALSE(journal->record("two", "jobs/2").ok());
    }
    EXPECT_EQ(std::filesystem::file_size(path_), whole);
    ASSERT_TRUE(journal->record("three", "jobs/3").ok());
  }
  EXPECT_EQ(*jobs_of_journal(path_), (std::vector<std::string>{"jobs/1", "jobs/3"}));
  EXPECT_EQ(open()->job_of("two"), std::nullopt);
}

TEST_F(JournalTest, BelongsToOneProcessAndOneServer) {
  {
    const auto journal = open();
    EXPECT_THAT(std::string(Journal::open(path_, kServer).status().message()),
                HasSubstr("another process"));
  }
  EXPECT_THAT(std::string(Journal::open(path_, "other:1").status().message()),
              HasSubstr(kServer));
}

TEST_F(JournalTest, LeavesAFileOfAnotherKindAsItIs) {
  for (const std::string& text :
       std::vector<std::string>{"# a manifest\nbunny.vdb", "bunny.vdb", "{\"input\": 1}"}) {
    std::ofstream(path_) << text;
    EXPECT_TRUE(absl::IsFailedPrecondition(Journal::open(path_, kServer).status())) << text;
    EXPECT_EQ(std::filesystem::file_size(path_), text.size());
  }
}

TEST_F(JournalTest, BeginsAnewWhereItsFirstLineWasNotWrittenToItsEnd) {
  std::ofstream(path_) << R"({"submission":"12)";
  const std::string id = open()->request_id("order", 0);
  EXPECT_EQ(open()->request_id("order", 0), id);
}

}  // namespace
}  // namespace tet
