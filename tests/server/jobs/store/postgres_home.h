// A job store in a schema of the test's own, on the server of this program's tests.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "server/jobs/store/postgres_job_store.h"
#include "tests/server/jobs/store/postgres_server.h"
#include "tests/server/jobs/store/store_home.h"

namespace tet::test {

/// One for all tests of the program, since it takes seconds to start.
inline PostgresServer& postgres_server() {
  static PostgresServer server;
  return server;
}

class PostgresHome final : public StoreHome {
 public:
  /// In a schema of its own, without tables.
  PostgresHome() : schema_("home" + std::to_string(++count())) {
    postgres_server().make_schema(schema_);
  }
  /// In a schema that others had before and that was emptied: making tables takes longer than
  /// most tests.
  explicit PostgresHome(const std::string& used_schema) : schema_(used_schema) {}

  std::unique_ptr<JobStore> open(const SqlJobStore::Options& rules) const override {
    return open_with({.connection = connection(), .rules = rules});
  }
  std::unique_ptr<JobStore> open_with(const PostgresOptions& options) const {
    auto store = open_postgres_job_store(options);
    EXPECT_TRUE(store.ok()) << store.status();
    return store.ok() ? *std::move(store) : nullptr;
  }
  std::vector<std::string> worker_arguments() const override {
    return {"postgres", connection()};
  }
  const std::string& schema() const { return schema_; }
  std::string connection() const { return postgres_server().connection(schema_); }

 private:
  static int& count() {
    static int homes = 0;
    return homes;
  }

  const std::string schema_;
};

inline std::unique_ptr<StoreHome> make_postgres_home() {
  return std::make_unique<PostgresHome>();
}

}  // namespace tet::test
