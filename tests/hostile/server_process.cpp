#include "tests/hostile/server_process.h"

#include <csignal>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <spawn.h>
#include <sstream>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>
#include <utility>

#include <absl/strings/str_cat.h>

#include "tests/support/eventually.h"

namespace tet::test {

namespace {

pid_t spawn(const std::vector<std::string>& arguments, const std::string& log) {
  std::vector<char*> argv;
  for (const std::string& argument : arguments)
    argv.push_back(const_cast<char*>(argument.data()));
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, log.c_str(),
                                   O_WRONLY | O_CREAT | O_TRUNC, 0600);
  pid_t pid = -1;
  if (posix_spawn(&pid, argv[0], &actions, nullptr, argv.data(), environ) != 0) pid = -1;
  posix_spawn_file_actions_destroy(&actions);
  return pid;
}

/// The port, once the server has written it.
std::string wait_for_port(const std::string& path) {
  std::string port;
  eventually([&] { return static_cast<bool>(std::ifstream(path) >> port); });
  return port;
}

/// What a process has used, those that it has waited for, and its children that run; see
/// proc(5).
double processor_seconds_of(const std::string& pid) {
  constexpr int kBeforeTimes = 11, kTimes = 4;  // after the name, which ends with a parenthesis
  std::string line;
  std::getline(std::ifstream("/proc/" + pid + "/stat"), line);
  const std::size_t name_end = line.rfind(')');
  if (name_end == std::string::npos) return 0;  // it has ended
  std::istringstream fields(line.substr(name_end + 1));
  std::string skipped;
  for (int i = 0; i < kBeforeTimes; ++i) fields >> skipped;
  double seconds = 0;
  for (int i = 0; i < kTimes; ++i) {
    double ticks = 0;
    fields >> ticks;
    seconds += ticks / static_cast<double>(::sysconf(_SC_CLK_TCK));
  }
  std::error_code ended;
  for (const auto& thread :
       std::filesystem::directory_iterator("/proc/" + pid + "/task", ended)) {
    std::ifstream children(thread.path() / "children");
    for (std::string child; children >> child;) seconds += processor_seconds_of(child);
  }
  return seconds;
}

}  // namespace

absl::StatusOr<ServerProcess> ServerProcess::start(const std::string& program,
                                                   const std::string& folder,
                                                   const std::vector<std::string>& settings) {
  std::filesystem::create_directories(folder);
  const std::string port_file = folder + "/port";
  std::filesystem::remove(port_file);
  std::vector<std::string> arguments{program,   "--listen",        "127.0.0.1:0",
                                     "--store", folder + "/store", "--port-file",
                                     port_file, "--log-level",     "error"};
  arguments.insert(arguments.end(), settings.begin(), settings.end());
  ServerProcess server(spawn(arguments, folder + "/log"));
  const std::string port = server.pid_ < 0 ? "" : wait_for_port(port_file);
  if (port.empty()) {
    return absl::UnavailableError(absl::StrCat("no server: see ", folder, "/log"));
  }
  server.address_ = "127.0.0.1:" + port;
  return server;
}

ServerProcess::ServerProcess(ServerProcess&& from) noexcept
    : pid_(std::exchange(from.pid_, -1)), address_(std::move(from.address_)) {}

ServerProcess::~ServerProcess() {
  if (pid_ < 0) return;
  ::kill(pid_, SIGKILL);
  ::waitpid(pid_, nullptr, 0);
}

bool ServerProcess::alive() {
  if (pid_ >= 0 && ::waitpid(pid_, nullptr, WNOHANG) != 0) pid_ = -1;
  return pid_ >= 0;
}

double ServerProcess::processor_seconds() const {
  return processor_seconds_of(std::to_string(pid_));
}

std::uint64_t ServerProcess::peak_resident_bytes() const {
  std::ifstream status(absl::StrCat("/proc/", pid_, "/status"));
  for (std::string word; status >> word;) {
    std::uint64_t kib = 0;
    if (word == "VmHWM:" && status >> kib) return kib << 10;
  }
  return 0;
}

bool ServerProcess::stop() {
  ::kill(pid_, SIGTERM);
  int status = 0;
  ::waitpid(std::exchange(pid_, -1), &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace tet::test
