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
  std::unique_ptr<JobStore> open(const SqlJobStore::Options& rules) const override {
    return open_with({.connection = connection(), .rules = rules});
  }
  /// No transaction is ended because a thread of the test stands still in it.
  std::unique_ptr<JobStore> open_with(PostgresOptions options) const {
    options.idle_in_transaction = absl::Hours(1);
    auto store = open_postgres_job_store(options);
    EXPECT_TRUE(store.ok()) << store.status();
    return store.ok() ? *std::move(store) : nullptr;
  }
  std::vector<std::string> worker_arguments() const override {
    return {"postgres", connection()};
  }
  /// Leaves the rows and sequences of a store that was just made, whatever tables it has:
  /// making those takes longer than most tests.
  void empty() const {
    postgres_server().run(schema_, R"sql(
DO $$ DECLARE name text; BEGIN
  FOR name IN SELECT oid::regclass FROM pg_class
      WHERE relnamespace = current_schema::regnamespace AND relkind IN ('r', 'p')
        AND NOT relispartition AND relname <> 'schema_version' LOOP
    EXECUTE 'DELETE FROM ' || name;
  END LOOP;
  FOR name IN SELECT sequencename FROM pg_sequences WHERE schemaname = current_schema LOOP
    PERFORM setval(name::regclass, 1, false);
  END LOOP;
  INSERT INTO counters VALUES ('revision', 0), ('compacted', 0);
END $$)sql");
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

/// In the schema that all its homes share, emptied: one at a time.
class EmptiedPostgresHome final : public StoreHome {
 public:
  EmptiedPostgresHome() { shared().empty(); }

  std::unique_ptr<JobStore> open(const SqlJobStore::Options& rules) const override {
    return shared().open(rules);
  }
  std::vector<std::string> worker_arguments() const override {
    return shared().worker_arguments();
  }
  static const PostgresHome& shared() {
    static const PostgresHome home;
    static const bool made = home.open({}) != nullptr;
    EXPECT_TRUE(made);
    return home;
  }
};

inline std::unique_ptr<StoreHome> make_emptied_postgres_home() {
  return std::make_unique<EmptiedPostgresHome>();
}

}  // namespace tet::test
