// A job store in a file of the test's own.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "server/jobs/store/sqlite_job_store.h"
#include "tests/server/jobs/store/store_home.h"
#include "tests/server/test_folder.h"

namespace tet::test {

class SqliteHome final : public StoreHome {
 public:
  std::unique_ptr<JobStore> open(const SqlJobStore::Options& rules) const override {
    // However long a busy disk takes over the commits of others.
    auto store = open_sqlite_job_store(
        {.path = path(), .busy_timeout = absl::Minutes(5), .rules = rules});
    EXPECT_TRUE(store.ok()) << store.status();
    return store.ok() ? *std::move(store) : nullptr;
  }
  std::vector<std::string> worker_arguments() const override { return {"sqlite", path()}; }
  std::string path() const { return folder_.file("jobs.db"); }

 private:
  const TestFolder folder_;
};

inline std::unique_ptr<StoreHome> make_sqlite_home() { return std::make_unique<SqliteHome>(); }

}  // namespace tet::test
