#include "server/jobs/results/whole_file.h"

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

absl::StatusOr<std::string> read_file(const fs::path& path) {
  const auto file = open_file(path, O_RDONLY);
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
  auto file = AtomicFile::create_at(path, {"", kUnfinished, kFileMode, disk_error});
  if (!file.ok()) return file.status();
  const absl::Status written = write(file->file());
  return written.ok() ? file->commit_unsynced() : written;
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
