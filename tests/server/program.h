// A program run by a test: its exit code and what it printed.
#pragma once

#include <csignal>
#include <fcntl.h>
#include <fstream>
#include <map>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

#include "tests/server/test_folder.h"

namespace tet::test {

/// A running process; killed if the test forgets it.
class Program {
 public:
  Program(const TestFolder& folder,
          std::vector<std::string> arguments,
          const std::map<std::string, std::string>& environment = {})
      : out_(folder.file("stdout")), err_(folder.file("stderr")) {
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    pid_ = ::fork();
    if (pid_ != 0) return;
    redirect(out_, STDOUT_FILENO);
    redirect(err_, STDERR_FILENO);
    ::setenv("TETSTREAM_LAME_DUCK_SECONDS", "0", 1);  // or each server's end takes seconds
    for (const auto& [name, value] : environment) ::setenv(name.c_str(), value.c_str(), 1);
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  ~Program() {
    if (pid_ <= 0) return;
    send(SIGKILL);
    wait();
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  pid_t pid() const { return pid_; }

  void send(int signal) const { ::kill(pid_, signal); }

  /// Its exit code once it has ended; -1 if a signal ended it.
  int wait() {
    int status = 0;
    ::waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  std::string out() const { return read_text(out_); }
  std::string err() const { return read_text(err_); }

 private:
  /// To its end: a server and its workers may have one file.
  static void redirect(const std::string& path, int to) {
    ::dup2(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_APPEND, 0600), to);
  }

  std::string out_, err_;
  pid_t pid_ = -1;
};

}  // namespace tet::test
