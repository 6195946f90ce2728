#include "core/vdb/write_vdb.h"

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <exception>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <ios>
#include <system_error>
#include <unistd.h>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <openvdb/io/Archive.h>

namespace tet {
namespace {

/// OpenVDB's own File does not look whether the disk was full; this stream throws.
class VdbWriter : private openvdb::io::Archive {
 public:
  using openvdb::io::Archive::write;

  void write_file(const openvdb::GridBase::ConstPtr& grid, const std::string& path) {
    std::ofstream stream;
    stream.exceptions(std::ios::failbit | std::ios::badbit);
    stream.open(path, std::ios::binary | std::ios::trunc);
    Archive::write(stream, openvdb::GridCPtrVec{grid}, /*seekable=*/true);
    stream.close();
  }
};

/// A name beside `path` that no other writer uses.
std::string temporary_name(const std::string& path) {
  static std::atomic<unsigned> next{0};
  return absl::StrCat(path, ".", ::getpid(), "-", next++, ".tmp");
}

void sync(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const bool synced = file >= 0 && ::fsync(file) == 0;
  const int error = errno;
  if (file >= 0) ::close(file);
  if (!synced) throw std::system_error(error, std::generic_category());
}

}  // namespace

absl::Status write_vdb(const openvdb::GridBase::ConstPtr& grid, const std::string& path) {
  const std::string temporary = temporary_name(path);
  errno = 0;
  try {
    VdbWriter().write_file(grid, temporary);
    sync(temporary);
    std::filesystem::rename(temporary, path);
    sync(std::filesystem::absolute(path).parent_path());
    return absl::OkStatus();
  } catch (const std::exception& error) {
    // A stream's exception does not say why; the system call that failed did.
    const std::string why =
        errno != 0 ? std::generic_category().message(errno) : std::string(error.what());
    std::remove(temporary.c_str());
    return absl::UnavailableError(absl::StrFormat("'%s' cannot be written: %s", path, why));
  }
}

}  // namespace tet
