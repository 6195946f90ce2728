// A PostgreSQL server of the test's own: in a temporary folder, on a Unix socket, gone
// afterwards.
#pragma once

#include <filesystem>
#include <string>
#include <sys/types.h>
#include <vector>

#include "tests/server/test_folder.h"

namespace tet::test {

/// Debian's PostgreSQL 15, run as the user `postgres` where the test is root, which it refuses
/// to run as. Throws std::runtime_error if it does not come up.
class PostgresServer {
 public:
  /// Without `durable`, commits survive a killed server as well, though not a power cut: tests
  /// do the one and not the other, and need not wait for the disk.
  explicit PostgresServer(bool durable = false, int max_connections = 60);
  ~PostgresServer();
  PostgresServer(const PostgresServer&) = delete;
  PostgresServer& operator=(const PostgresServer&) = delete;

  /// For libpq; `schema` is the search path.
  std::string connection(const std::string& schema) const;
  void make_schema(const std::string& schema) const;
  /// Runs statements in a schema. Throws std::runtime_error if one fails.
  void run(const std::string& schema, const std::string& sql) const;

  /// kill -9 of the server and so of all it runs.
  void kill();
  /// Starts it again on what the disk has.
  void start();

 private:
  pid_t spawn(std::vector<std::string> arguments) const;
  void end(int signal);
  bool answers() const;

  const bool durable_;
  const int max_connections_;
  const TestFolder folder_;
  pid_t server_ = -1;
};

}  // namespace tet::test
