#include "tests/server/jobs/store/postgres_server.h"

#include <csignal>
#include <fcntl.h>
#include <grp.h>
#include <libpq-fe.h>
#include <pwd.h>
#include <stdexcept>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/eventually.h"

namespace tet::test {

namespace {

constexpr char kPrograms[] = "/usr/lib/postgresql/15/bin/";

/// In the child only.
void leave_root() {
  if (::getuid() != 0) return;
  const passwd* user = ::getpwnam("postgres");
  if (!user || ::setgroups(0, nullptr) != 0 || ::setgid(user->pw_gid) != 0 ||
      ::setuid(user->pw_uid) != 0) {
    ::_exit(126);
  }
}

void give_to_postgres(const std::filesystem::path& folder) {
  if (::getuid() != 0) return;
  const passwd* user = ::getpwnam("postgres");
  if (!user || ::chown(folder.c_str(), user->pw_uid, user->pw_gid) != 0) {
    throw std::runtime_error("there is no user postgres (Debian package postgresql)");
  }
}

}  // namespace

PostgresServer::PostgresServer(bool durable, int max_connections)
    : durable_(durable), max_connections_(max_connections) {
  give_to_postgres(folder_.path());
  const pid_t initdb = spawn({std::string(kPrograms) + "initdb", "-D", folder_.file("data"),
                              "-U", "tetstream", "--auth=trust", "--encoding=UTF8",
                              "--locale=C", "--no-sync", "--no-instructions"});
  int status = 0;
  ::waitpid(initdb, &status, 0);
  if (status != 0) throw std::runtime_error("initdb failed: " + read_text(folder_.file("log")));
  start();
}

/// Told to stop at once, not killed: what is killed leaves its shared memory to the machine.
PostgresServer::~PostgresServer() {
  if (server_ > 0) end(SIGQUIT);
}

pid_t PostgresServer::spawn(std::vector<std::string> arguments) const {
  std::vector<char*> argv;
  argv.reserve(arguments.size() + 1);
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const std::string log = folder_.file("log");
  const pid_t child = ::fork();
  if (child != 0) return child;
  leave_root();
  const int out = ::open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
  ::dup2(out, STDOUT_FILENO);
  ::dup2(out, STDERR_FILENO);
  if (::chdir("/") == 0) ::execv(argv[0], argv.data());
  ::_exit(127);
}

bool PostgresServer::answers() const {
  return PQping(connection("public").c_str()) == PQPING_OK;
}

void PostgresServer::start() {
  // After a kill, the server waits for what it ran to be gone: it is started until it stays.
  const bool started = eventually([&] {
    if (server_ <= 0 || ::waitpid(server_, nullptr, WNOHANG) == server_) {
      server_ = spawn({std::string(kPrograms) + "postgres", "-D", folder_.file("data"), "-k",
                       folder_.path().string(), "-c", "listen_addresses=", "-c",
                       "max_connections=" + std::to_string(max_connections_), "-c",
                       "shared_buffers=32MB", "-c", durable_ ? "fsync=on" : "fsync=off"});
    }
    return answers();
  });
  if (started) return;
  throw std::runtime_error("PostgreSQL does not start: " + read_text(folder_.file("log")));
}

void PostgresServer::kill() { end(SIGKILL); }

void PostgresServer::end(int signal) {
  ::kill(server_, signal);
  ::waitpid(server_, nullptr, 0);
  server_ = -1;
}

std::string PostgresServer::connection(const std::string& schema) const {
  return "host=" + folder_.path().string() +
         " dbname=postgres user=tetstream options='-c search_path=" + schema + "'";
}

void PostgresServer::make_schema(const std::string& schema) const {
  run("public", "CREATE SCHEMA " + schema);
}

void PostgresServer::run(const std::string& schema, const std::string& sql) const {
  PGconn* connected = PQconnectdb(connection(schema).c_str());
  PGresult* result = PQexec(connected, sql.c_str());
  const bool ok = PQresultStatus(result) == PGRES_COMMAND_OK;
  const std::string message = PQerrorMessage(connected);
  PQclear(result);
  PQfinish(connected);
  if (!ok) throw std::runtime_error(sql + ": " + message);
}

}  // namespace tet::test
