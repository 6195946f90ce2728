#include "server/upkeep/store_files.h"

#include <cerrno>
#include <optional>
#include <string>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <vector>

#include <absl/strings/match.h>

#include "core/base/posix/atomic_file.h"
#include "core/base/posix/folder.h"
#include "proto/wire/sha256.h"
#include "server/grids/store_identity.h"
#include "server/ops/disk.h"
#include "server/rpc/default_namespace.h"

namespace tet {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kCopyBytes = std::size_t{1} << 20;

/// A name like 64 hexadecimal digits and an ending.
bool is_upload(const std::string& name) {
  return absl::EndsWith(name, ".part") && is_sha256_hex(name.substr(0, name.size() - 5));
}

/// Takes a path below results/{namespace}.
bool is_result(const std::vector<std::string>& parts) {
  const std::string& name = parts.back();
  if (parts.size() == 2) return parts[0] == "plans" && is_sha256_hex(name);
  return parts.size() == 4 && parts[0] == "meshes" && is_sha256_hex(parts[2]) &&
         (is_sha256_hex(name) ||
          (absl::StartsWith(name, "shard-") && name.find('.') == name.npos));
}

/// Takes a path below the store or the folder of a namespace.
std::optional<FileKind> kind_below(const std::vector<std::string>& parts) {
  const std::string& name = parts.back();
  if (parts.size() == 3 && parts[0] == "grids" && is_sha256_hex(name)) return FileKind::kNever;
  if (parts.size() == 2 && parts[0] == "uploads" && is_upload(name)) return FileKind::kGrows;
  return std::nullopt;
}

std::optional<FileKind> kind_of(const fs::path& relative) {
  std::vector<std::string> parts;
  for (const fs::path& part : relative) parts.push_back(part.string());
  if (parts.size() == 1) {
    if (parts[0] == kStoreIdentityFile) return FileKind::kNever;
    return std::nullopt;
  }
  if (parts[0] == "results" && parts.size() > 3) {
    const bool kept = is_result({parts.begin() + 2, parts.end()});
    return kept ? std::optional(FileKind::kNever) : std::nullopt;
  }
  if (parts[0] == "namespaces" && parts.size() > 3) {
    return kind_below({parts.begin() + 2, parts.end()});
  }
  return kind_below(parts);
}

absl::Status copy_bytes(const File& from, AtomicFile& to) {
  std::vector<char> bytes(kCopyBytes);
  for (std::uint64_t offset = 0;;) {
    const auto count = from.read_at(offset, bytes);
    if (!count.ok()) return count.status();
    if (*count == 0) return absl::OkStatus();
    const auto written = to.write(std::as_bytes(std::span(bytes.data(), *count)));
    if (!written.ok()) return written;
    offset += *count;
  }
}

void take_time_over(const fs::path& from, const File& to) {
  struct stat info {};
  if (::stat(from.c_str(), &info) != 0) return;
  const timespec times[2] = {info.st_atim, info.st_mtim};
  ::futimens(to.descriptor().number(), times);
}

/// Folders that go while they are looked at, being evicted, have no files.
absl::Status walk(const fs::path& store,
                  const fs::path& below,
                  const std::function<absl::Status(const StoreFile&)>& visit) {
  std::error_code error;
  for (fs::directory_iterator it(store / below, error), end; !error && it != end;
       it.increment(error)) {
    const fs::path relative = below / it->path().filename();
    std::error_code gone;
    absl::Status status;
    if (it->is_directory(gone)) {
      status = walk(store, relative, visit);
    } else if (const auto kind = kind_of(relative); kind && it->is_regular_file(gone)) {
      status = visit({relative, *kind});
    }
    if (!status.ok()) return status;
  }
  if (!error || error == std::errc::no_such_file_or_directory) return absl::OkStatus();
  return absl::InternalError("cannot read " + (store / below).string() + ": " +
                             error.message());
}

}  // namespace

absl::Status for_each_store_file(const fs::path& store,
                                 const std::function<absl::Status(const StoreFile&)>& visit) {
  return walk(store, {}, visit);
}

fs::path grid_file(const std::string& space, const std::string& digest) {
  const fs::path below = fs::path("grids") / digest.substr(0, 2) / digest;
  return space == kDefaultSpace ? below : fs::path("namespaces") / space / below;
}

absl::Status copy_whole_file(const fs::path& from, const fs::path& to) {
  const auto source = File::open(from, O_RDONLY, io_error);
  if (!source.ok()) return source.status();
  if (auto made = make_folder(to.parent_path(), 0750, io_error); !made.ok()) return made;
  auto target = AtomicFile::create_at(to, {".copy.", ".part", kFileMode, io_error});
  if (!target.ok()) return target.status();
  if (auto copied = copy_bytes(*source, *target); !copied.ok()) return copied;
  take_time_over(from, target->file());
  return target->commit_unsynced();
}

absl::Status link_or_copy(const fs::path& from, const fs::path& to) {
  if (auto made = make_folder(to.parent_path(), 0750, io_error); !made.ok()) return made;
  // Beside its place first: an older file of the name is replaced in one step.
  const fs::path beside = to.string() + ".link.part";
  ::unlink(beside.c_str());
  if (::link(from.c_str(), beside.c_str()) != 0) {
    if (errno == ENOENT) return absl::NotFoundError(from.string() + " is gone");
    return copy_whole_file(from, to);
  }
  std::error_code error;
  fs::rename(beside, to, error);
  // Where both are one file already, nothing was renamed.
  ::unlink(beside.c_str());
  if (!error) return absl::OkStatus();
  return absl::InternalError("cannot rename " + beside.string() + ": " + error.message());
}

}  // namespace tet
