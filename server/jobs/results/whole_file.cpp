#include "server/jobs/results/whole_file.h"

#include <cstdio>
#include <fcntl.h>
#include <random>
#include <system_error>

#include <absl/strings/str_format.h>

#include "proto/wire/sha256.h"

namespace tet {

namespace fs = std::filesystem;

namespace {

constexpr char kUnfinished[] = ".part";
constexpr std::size_t kDigits = 64;

std::string digest_of(std::string_view text) {
  Sha256 digest;
  digest.add(text);
  return digest.finish_hex();
}

/// No two writers, on whatever host, write the same unfinished file.
fs::path unfinished(const fs::path& path) {
  thread_local std::mt19937_64 random{std::random_device{}()};
  return path.parent_path() / absl::StrFormat("%016x%s", random(), kUnfinished);
}

absl::StatusOr<std::string> read_file(const fs::path& path) {
  const auto file = File::open(path, O_RDONLY);
  if (!file.ok()) return file.status();
  const auto size = file->size();
  if (!size.ok()) return size.status();
  std::string text(*size, '\0');
  const auto count = file->read_at(0, text);
  if (!count.ok()) return count.status();
  text.resize(*count);
  return text;
}

}  // namespace

bool is_unfinished(const fs::path& path) { return path.extension() == kUnfinished; }

absl::Status write_whole(const fs::path& path,
                         const std::function<absl::Status(File&)>& write) {
  const fs::path beside = unfinished(path);
  auto file = File::open(beside, O_WRONLY | O_CREAT | O_EXCL);
  absl::Status status = file.status();
  if (status.ok()) status = write(*file);
  if (status.ok()) status = file->sync();
  if (status.ok() && ::rename(beside.c_str(), path.c_str()) != 0) {
    status = disk_error("cannot move", beside);
  }
  std::error_code ignored;
  if (!status.ok()) fs::remove(beside, ignored);
  return status;
}

absl::Status write_checked(const fs::path& path, std::string_view text) {
  const absl::Status written = write_whole(path, [&](File& file) {
    const absl::Status status = file.write_at(0, text);
    return status.ok() ? file.write_at(text.size(), digest_of(text)) : status;
  });
  return written.ok() ? sync_folder(path.parent_path()) : written;
}

std::optional<std::string> read_checked(const fs::path& path) {
  auto text = read_file(path);
  if (!text.ok() || text->size() < kDigits) return std::nullopt;
  const std::string digest = text->substr(text->size() - kDigits);
  text->resize(text->size() - kDigits);
  if (digest_of(*text) != digest) return std::nullopt;
  return *std::move(text);
}

}  // namespace tet
