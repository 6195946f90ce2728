#include "core/vdb/decoder/spawn.h"

#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <spawn.h>

#include <absl/strings/str_format.h>

#include "core/base/failure_name.h"

namespace tet {
namespace {

/// What the new process does between its start and the program's.
struct Preparation {
  Preparation(int descriptor, int as) {
    ::posix_spawn_file_actions_init(&files);
    ::posix_spawn_file_actions_adddup2(&files, descriptor, as);
    for (int standard = 0; standard < 3; ++standard) {
      ::posix_spawn_file_actions_addopen(&files, standard, "/dev/null", O_RDWR, 0);
    }
    ::posix_spawn_file_actions_addclosefrom_np(&files, as + 1);
    sigset_t none, all;
    sigemptyset(&none);
    sigfillset(&all);
    ::posix_spawnattr_init(&attributes);
    ::posix_spawnattr_setsigmask(&attributes, &none);
    ::posix_spawnattr_setsigdefault(&attributes, &all);
    ::posix_spawnattr_setpgroup(&attributes, 0);
    ::posix_spawnattr_setflags(
        &attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  }
  ~Preparation() {
    ::posix_spawn_file_actions_destroy(&files);
    ::posix_spawnattr_destroy(&attributes);
  }
  Preparation(const Preparation&) = delete;
  Preparation& operator=(const Preparation&) = delete;

  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
};

}  // namespace

absl::StatusOr<pid_t> spawn(const std::string& path,
                            const std::vector<std::string>& environment,
                            int descriptor,
                            int as) {
  const Preparation preparation(descriptor, as);
  std::string name = path;
  std::vector<std::string> variables = environment;
  std::vector<char*> arguments{name.data(), nullptr}, values;
  for (std::string& variable : variables) values.push_back(variable.data());
  values.push_back(nullptr);
  pid_t pid = 0;
  const int error = ::posix_spawn(&pid, path.c_str(), &preparation.files,
                                  &preparation.attributes, arguments.data(), values.data());
  if (error == 0) return pid;
  return named_failure("DECODER_UNAVAILABLE",
                       absl::UnavailableError(absl::StrFormat("'%s' cannot be started: %s",
                                                              path, std::strerror(error))));
}

}  // namespace tet
