#include "core/base/posix/folder.h"

#include <cerrno>
#include <cstdio>
#include <fcntl.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

#include "core/base/posix/descriptor.h"

namespace tet {

namespace fs = std::filesystem;

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

absl::Status sync_folder(const fs::path& path, IoErrorTeller tell) {
  const Descriptor folder = open_descriptor(path, O_RDONLY | O_DIRECTORY);
  // Whoever may write a folder and not read it has no way to flush it: the file has its name.
  if (!folder.is_open() && errno == EACCES) return absl::OkStatus();
  if (!folder.is_open()) return tell("open", path);
  if (::fdatasync(folder.number()) == 0 || errno == EINVAL) return absl::OkStatus();
  return tell("flush", path);
}

absl::Status make_folder(const fs::path& path, mode_t mode, IoErrorTeller tell) {
  std::error_code ignored;
  if (path.empty() || fs::is_directory(path, ignored)) return absl::OkStatus();
  if (auto above = make_folder(path.parent_path(), mode, tell); !above.ok()) return above;
  if (::mkdir(path.c_str(), mode) != 0 && errno != EEXIST) return tell("make", path);
  return sync_folder(folder_of(path), tell);
}

absl::Status move_file(const fs::path& from, const fs::path& to, IoErrorTeller tell) {
  if (::rename(from.c_str(), to.c_str()) != 0) return tell("move", from);
  return sync_folder(folder_of(to), tell);
}

}  // namespace tet
