// What a body of statements may rely on when one of them has to give way.
#include "server/jobs/store/sql_transaction.h"

#include <memory>
#include <vector>

#include <gtest/gtest.h>

namespace tet::test {
namespace {

/// Each answer is one row with the number of the statement; some statements give way.
class PlayedConnection final : public SqlConnection {
 public:
  PlayedConnection(int& statements, int gives_way)
      : statements_(statements), gives_way_(gives_way) {}

  absl::StatusOr<SqlResult> run(std::string_view /*sql*/,
                                std::span<const SqlValue> /*values*/) override {
    if (++statements_ == gives_way_) return absl::AbortedError("deadlock detected");
    return SqlResult{{SqlRow({std::int64_t{statements_}})}, 0};
  }
  absl::StatusOr<std::int64_t> begin() override { return 0; }
  absl::Status commit() override { return absl::OkStatus(); }
  void roll_back() noexcept override {}

 private:
  int& statements_;
  const int gives_way_;
};

class PlayedDatabase final : public SqlDatabase {
 public:
  explicit PlayedDatabase(int gives_way) : gives_way_(gives_way) {}

  absl::StatusOr<SqlPool::Lease> reader() override { return pool_.take(); }
  absl::StatusOr<SqlPool::Lease> writer() override { return pool_.take(); }
  const char* for_update() const override { return ""; }
  const char* skip_locked() const override { return ""; }
  const char* next_token() const override { return ""; }
  void announce() override {}
  std::uint64_t signal() override { return 0; }
  void wait(std::uint64_t /*seen*/, absl::Duration /*timeout*/) override {}
  void wake_all() override {}
  absl::StatusOr<std::int64_t> purge(std::int64_t /*finished_before_us*/) override { return 0; }

 private:
  const int gives_way_;
  int statements_ = 0;
  SqlPool pool_{1, [this]() -> absl::StatusOr<std::unique_ptr<SqlConnection>> {
                  return std::make_unique<PlayedConnection>(statements_, gives_way_);
                }};
};

TEST(SqlTransaction, ReadsAgainFromTheBeginningWhatHadToGiveWay) {
  PlayedDatabase database(2);
  std::vector<std::int64_t> seen;
  const absl::Status status = read(database, [&](SqlTransaction& t) {
    seen = {t.integer("first")};
    seen.push_back(t.integer("second"));
    return absl::OkStatus();
  });
  EXPECT_EQ(status, absl::OkStatus());
  EXPECT_EQ(seen, (std::vector<std::int64_t>{3, 4}));
}

TEST(SqlTransaction, DoesNotReadAgainBecauseTheBodySaysSo) {
  PlayedDatabase database(0);
  int reads = 0;
  const absl::Status status = read(database, [&](SqlTransaction&) {
    ++reads;
    return absl::AbortedError("somebody else has it");
  });
  EXPECT_TRUE(absl::IsAborted(status));
  EXPECT_EQ(reads, 1);
}

}  // namespace
}  // namespace tet::test
