#include "core/vdb/openvdb/write_vdb.h"

#include <cerrno>
#include <exception>
#include <filesystem>
#include <fstream>
#include <ios>
#include <string_view>
#include <system_error>

#include <absl/strings/str_format.h>
#include <openvdb/io/Archive.h>

#include "core/base/posix/atomic_file.h"

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

absl::Status cannot_write(const std::string& path, const std::string& why) {
  return absl::UnavailableError(absl::StrFormat("'%s' cannot be written: %s", path, why));
}

/// How this file tells errors of the layer below.
absl::Status write_error(std::string_view, const std::filesystem::path& path) {
  return cannot_write(path, std::generic_category().message(errno));
}

}  // namespace

absl::Status write_vdb(const openvdb::GridBase::ConstPtr& grid, const std::string& path) {
  auto file = AtomicFile::create_at(path, {.tell = write_error});
  if (!file.ok()) return file.status();
  errno = 0;
  try {
    VdbWriter().write_file(grid, file->temporary_path());
  } catch (const std::exception& error) {
    // A stream's exception does not say why; the system call that failed did.
    if (errno != 0) return write_error("write", path);
    return cannot_write(path, error.what());
  }
  return file->commit();
}

}  // namespace tet
