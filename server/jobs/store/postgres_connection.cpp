#include "server/jobs/store/postgres_connection.h"

#include <cstdlib>
#include <poll.h>
#include <utility>
#include <vector>

#include <absl/strings/ascii.h>
#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>

#include "server/jobs/store/store_errors.h"

namespace tet {

namespace {

// Numbers of PostgreSQL's own types, which never change.
constexpr Oid kBool = 16;
constexpr Oid kBytea = 17;
constexpr Oid kInt8 = 20;
constexpr Oid kText = 25;

// Plans are made once. They must be good for a queue of any length: one that was made while it
// was short would read all of a long one, unless it has to use an index.
// Where one is read whole nevertheless, the price that keeps others from it looks as if the
// query were worth compiling: that took most of the database's time.
constexpr char kSettings[] =
    "SET lock_timeout = '10s'; SET synchronous_commit = on; SET client_min_messages = warning; "
    "SET enable_seqscan = off; SET jit = off; SET plan_cache_mode = force_generic_plan";

struct Clear {
  void operator()(PGresult* result) const { PQclear(result); }
};
using Result = std::unique_ptr<PGresult, Clear>;

std::string big_endian(std::int64_t value) {
  std::string bytes(8, '\0');
  for (std::size_t i = 0; i < 8; ++i) {
    bytes[i] = static_cast<char>(static_cast<std::uint64_t>(value) >> (56 - 8 * i));
  }
  return bytes;
}

std::int64_t from_big_endian(const char* bytes, int size) {
  std::uint64_t value = 0;
  for (int i = 0; i < size; ++i) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return static_cast<std::int64_t>(value);
}

Oid type_of(const SqlValue& value) {
  constexpr Oid kTypes[] = {kInt8, kText, kBytea};
  return kTypes[value.index()];
}

/// Parameters in binary, as libpq wants them.
struct Parameters {
  explicit Parameters(std::span<const SqlValue> values) : numbers(values.size()) {
    for (std::size_t i = 0; i < values.size(); ++i) add(values[i], numbers[i]);
  }

  void add(const SqlValue& value, std::string& number) {
    const std::string* bytes = &number;
    if (const auto* integer = std::get_if<std::int64_t>(&value)) number = big_endian(*integer);
    if (const auto* text = std::get_if<std::string>(&value)) bytes = text;
    if (const auto* blob = std::get_if<Blob>(&value)) bytes = &blob->bytes;
    pointers.push_back(bytes->data());
    lengths.push_back(static_cast<int>(bytes->size()));
    formats.push_back(1);
  }

  std::vector<std::string> numbers;
  std::vector<const char*> pointers;
  std::vector<int> lengths, formats;
};

SqlValue column(const PGresult* result, int row, int i) {
  const char* bytes = PQgetvalue(result, row, i);
  const auto size = static_cast<std::size_t>(PQgetlength(result, row, i));
  switch (PQftype(result, i)) {
    case kBool:
      return std::int64_t{bytes[0]};
    case kInt8:
      return from_big_endian(bytes, 8);
    case kBytea:
      return Blob{std::string(bytes, size)};
    default:
      return std::string(bytes, size);
  }
}

SqlResult rows_of(const PGresult* result) {
  SqlResult read;
  for (int row = 0; row < PQntuples(result); ++row) {
    std::vector<SqlValue> values;
    values.reserve(static_cast<std::size_t>(PQnfields(result)));
    for (int i = 0; i < PQnfields(result); ++i) values.push_back(column(result, row, i));
    read.rows.emplace_back(std::move(values));
  }
  auto* command = const_cast<PGresult*>(result);  // libpq only reads it
  // A SELECT counts what it found.
  if (!absl::StartsWith(PQcmdStatus(command), "SELECT ")) {
    read.changed = std::strtoll(PQcmdTuples(command), nullptr, 10);
  }
  return read;
}

bool is_in(const std::string& state, std::initializer_list<const char*> states) {
  for (const char* one : states) {
    if (state == one) return true;
  }
  return false;
}

}  // namespace

absl::StatusOr<std::unique_ptr<PostgresConnection>> PostgresConnection::open(
    const std::string& connection, absl::Duration idle_in_transaction) {
  const char* const keys[] = {"dbname",
                              "connect_timeout",
                              "keepalives_idle",
                              "keepalives_interval",
                              "keepalives_count",
                              "tcp_user_timeout",
                              "client_encoding",
                              "application_name",
                              nullptr};
  const char* const values[] = {connection.c_str(), "5",    "5", "5", "2", "15000", "UTF8",
                                "tetstream",        nullptr};
  std::unique_ptr<PostgresConnection> opened(
      new PostgresConnection(PQconnectdbParams(keys, values, 1)));
  // What libpq would print, between our log's lines, comes with the error of the call too.
  PQsetNoticeProcessor(
      opened->connection_.get(), [](void*, const char*) {}, nullptr);
  if (!opened->usable()) return opened->error(nullptr);
  const std::string settings =
      absl::StrCat(kSettings, "; SET idle_in_transaction_session_timeout = ",
                   absl::ToInt64Milliseconds(idle_in_transaction));
  if (auto set = opened->run_script(settings); !set.ok()) return set.status();
  return opened;
}

bool PostgresConnection::usable() const {
  return PQstatus(connection_.get()) == CONNECTION_OK &&
         PQtransactionStatus(connection_.get()) == PQTRANS_IDLE;
}

// A server that ends says so, or hangs up: either can be read. It has nothing else to tell.
bool PostgresConnection::survived() const {
  pollfd unasked{socket(), POLLIN, 0};
  return ::poll(&unasked, 1, 0) == 0;
}

absl::Status PostgresConnection::error(const PGresult* result) const {
  const char* found = result ? PQresultErrorField(result, PG_DIAG_SQLSTATE) : nullptr;
  const std::string state = found ? found : "";
  const std::string message =
      absl::StrCat("PostgreSQL: ",
                   std::string(absl::StripAsciiWhitespace(PQerrorMessage(connection_.get()))));
  if (PQstatus(connection_.get()) != CONNECTION_OK) return store_unavailable(message);
  // serialization_failure and deadlock_detected: another transaction went first.
  if (is_in(state, {"40001", "40P01"})) return absl::AbortedError(message);
  if (is_in(state, {"53100", "53200"})) return store_full(message);
  // lock_not_available, read_only_sql_transaction, too_many_connections, and shutting down.
  if (is_in(state, {"55P03", "25006", "53300", "57P01", "57P02", "57P03"})) {
    return store_unavailable(message);
  }
  return store_broken(absl::StrCat(message, " (", state, ")"));
}

absl::StatusOr<SqlResult> PostgresConnection::result_of(PGresult* raw) {
  const Result result(raw);
  const ExecStatusType status = PQresultStatus(result.get());
  if (status == PGRES_TUPLES_OK || status == PGRES_COMMAND_OK) return rows_of(result.get());
  return error(result.get());
}

absl::StatusOr<std::string> PostgresConnection::prepare(std::string_view sql,
                                                        std::span<const SqlValue> values) {
  if (const std::string* known = statements_.find(sql)) return *known;
  if (statements_.is_full()) {
    const auto gone = run_script(absl::StrCat("DEALLOCATE ", statements_.oldest()));
    if (!gone.ok()) return gone.status();
    statements_.drop_oldest();
  }
  std::vector<Oid> types;
  for (const SqlValue& value : values) types.push_back(type_of(value));
  const std::string name = absl::StrCat("s", prepared_++);
  const auto prepared =
      result_of(PQprepare(connection_.get(), name.c_str(), std::string(sql).c_str(),
                          static_cast<int>(types.size()), types.data()));
  if (!prepared.ok()) return prepared.status();
  return statements_.add(sql, name);
}

absl::StatusOr<SqlResult> PostgresConnection::run(std::string_view sql,
                                                  std::span<const SqlValue> values) {
  const auto name = prepare(sql, values);
  if (!name.ok()) return name.status();
  const Parameters parameters(values);
  return result_of(PQexecPrepared(connection_.get(), name->c_str(),
                                  static_cast<int>(values.size()), parameters.pointers.data(),
                                  parameters.lengths.data(), parameters.formats.data(), 1));
}

absl::StatusOr<SqlResult> PostgresConnection::run_script(const std::string& sql) {
  return result_of(PQexec(connection_.get(), sql.c_str()));
}

absl::StatusOr<std::int64_t> PostgresConnection::begin() {
  // Two statements in one trip; the last one's row comes back, as text.
  const auto now = run_script(
      "BEGIN; SELECT CAST(floor(extract(epoch FROM clock_timestamp()) * 1000000) AS "
      "BIGINT)::text");
  if (!now.ok()) return now.status();
  return std::strtoll(now->rows[0].text(0).c_str(), nullptr, 10);
}

absl::Status PostgresConnection::commit() {
  const auto committed = run_script("COMMIT");
  if (committed.ok()) return absl::OkStatus();
  roll_back();
  return committed.status();
}

void PostgresConnection::roll_back() noexcept {
  PQclear(PQexec(connection_.get(), "ROLLBACK"));
}

absl::StatusOr<bool> PostgresConnection::take_notifications() {
  if (PQconsumeInput(connection_.get()) == 0) return error(nullptr);
  bool any = false;
  while (PGnotify* notification = PQnotifies(connection_.get())) {
    any = true;
    PQfreemem(notification);
  }
  return any;
}

}  // namespace tet
