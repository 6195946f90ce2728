#include "core/base/posix/socket_file.h"

#include <cerrno>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <utility>

#include <absl/strings/str_cat.h>

#include "core/base/posix/folder.h"
#include "core/base/posix/io_error.h"

namespace tet {

namespace {

constexpr char kStagedName[] = "s";
constexpr int kStageNames = 100;

/// A short way to what is in an open folder.
std::string way_through(const Descriptor& folder, const std::string& name) {
  return absl::StrCat("/proc/self/fd/", folder.number(), "/", name);
}

/// Holds a folder among the processes that put socket files there.
class FolderTurn {
 public:
  explicit FolderTurn(const Descriptor& folder) : folder_(folder) {
    while (::flock(folder_.number(), LOCK_EX) != 0 && errno == EINTR) {
    }
  }
  ~FolderTurn() { ::flock(folder_.number(), LOCK_UN); }
  FolderTurn(const FolderTurn&) = delete;
  FolderTurn& operator=(const FolderTurn&) = delete;

 private:
  const Descriptor& folder_;
};

/// Whether nobody listens on a socket file: only then does the system refuse a connection. The
/// file is connected to by its number, as an address has room for a short path only and a name
/// may be as long as that alone.
bool is_abandoned(const Descriptor& folder, const std::string& name) {
  const Descriptor file = open_descriptor_in(folder, name, O_PATH | O_NOFOLLOW);
  if (!file.is_open()) return false;
  const std::string path = absl::StrCat("/proc/self/fd/", file.number());
  const Descriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, sizeof address.sun_path - 1);
  return socket.is_open() &&
         ::connect(socket.number(), reinterpret_cast<const sockaddr*>(&address),
                   sizeof address) != 0 &&
         errno == ECONNREFUSED;
}

}  // namespace

absl::Status check_socket_path(const std::string& path, std::size_t limit) {
  if (path.empty() || path.ends_with('/')) {
    return absl::InvalidArgumentError(
        absl::StrCat("the socket file '", path, "' has no name: write a path"));
  }
  if (path.find('\0') != std::string::npos) {
    return absl::InvalidArgumentError("the path of a socket file has a zero byte");
  }
  if (path.size() <= limit) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("the path of the socket file has ",
                                                 path.size(), " bytes, more than ", limit, ": ",
                                                 path));
}

absl::StatusOr<SocketFile> SocketFile::prepare(const std::string& path, std::size_t limit) {
  if (absl::Status status = check_socket_path(path, limit); !status.ok()) return status;
  SocketFile file;
  file.path_ = path;
  const std::filesystem::path folder = folder_of(path);
  file.name_ = std::filesystem::path(path).filename();
  file.folder_ = open_descriptor(folder, O_RDONLY | O_DIRECTORY);
  if (!file.folder_.is_open()) return io_error("open", folder);
  if (absl::Status status = file.make_way(); !status.ok()) return status;
  for (int attempt = 0; attempt < kStageNames && !file.stage_.is_open(); ++attempt) {
    const std::string name = absl::StrCat(".tetstream-", ::getpid(), "-", attempt);
    if (::mkdirat(file.folder_.number(), name.c_str(), 0700) != 0) {
      if (errno == EEXIST) continue;
      return io_error("make a folder in", folder);
    }
    file.stage_name_ = name;
    ::fchmodat(file.folder_.number(), name.c_str(), 0700, 0);  // whatever the umask left
    file.stage_ = open_descriptor(way_through(file.folder_, name), O_RDONLY | O_DIRECTORY);
    if (!file.stage_.is_open()) return io_error("open", folder / name);
  }
  if (!file.stage_.is_open()) return io_error("make a folder in", folder);
  file.bind_path_ = way_through(file.stage_, kStagedName);
  return file;
}

SocketFile::~SocketFile() {
  if (!folder_.is_open()) return;
  remove_stage();
  if (inode_ == 0) return;
  const FolderTurn turn(folder_);
  struct stat there {};
  if (::fstatat(folder_.number(), name_.c_str(), &there, AT_SYMLINK_NOFOLLOW) != 0) return;
  if (there.st_dev != device_ || there.st_ino != inode_) return;
  ::unlinkat(folder_.number(), name_.c_str(), 0);
}

absl::Status SocketFile::publish(mode_t rights) {
  const FolderTurn turn(folder_);
  absl::Status status = make_way();
  if (status.ok()) status = move_there(rights);
  remove_stage();
  return status;
}

/// Whether the socket may go to its path.
absl::Status SocketFile::make_way() const {
  struct stat there {};
  if (::fstatat(folder_.number(), name_.c_str(), &there, AT_SYMLINK_NOFOLLOW) != 0) {
    return errno == ENOENT ? absl::OkStatus() : io_error("look at", path_);
  }
  if (!S_ISSOCK(there.st_mode)) {
    return absl::FailedPreconditionError(
        absl::StrCat(path_, " is there and is no socket: take another path, or remove it"));
  }
  if (is_abandoned(folder_, name_)) return absl::OkStatus();
  return absl::UnavailableError(absl::StrCat("somebody listens on ", path_,
                                             " already, or it cannot be told whether: take "
                                             "another path, or end that process"));
}

/// Replaces an abandoned file in one step.
absl::Status SocketFile::move_there(mode_t rights) {
  struct stat staged {};
  const bool good =
      ::fchmodat(stage_.number(), kStagedName, rights, 0) == 0 &&
      ::fstatat(stage_.number(), kStagedName, &staged, AT_SYMLINK_NOFOLLOW) == 0 &&
      ::renameat(stage_.number(), kStagedName, folder_.number(), name_.c_str()) == 0;
  if (!good) return io_error("put a socket at", path_);
  device_ = staged.st_dev;
  inode_ = staged.st_ino;
  return absl::OkStatus();
}

void SocketFile::remove_stage() noexcept {
  if (stage_name_.empty()) return;
  ::unlinkat(stage_.number(), kStagedName, 0);
  ::unlinkat(folder_.number(), stage_name_.c_str(), AT_REMOVEDIR);
  stage_name_.clear();
}

}  // namespace tet
