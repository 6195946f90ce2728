#include "server/jobs/results/mesh_folder.h"

#include <sys/stat.h>
#include <system_error>

#include <absl/strings/escaping.h>
#include <absl/strings/str_cat.h>

#include "proto/convert/status.h"
#include "server/jobs/results/whole_file.h"
#include "server/ops/logging.h"

namespace tet {

namespace fs = std::filesystem;

namespace {

constexpr char kDamaged[] = ".damaged";

absl::Status chunk_damaged(const ChunkDigest& digest, std::string_view why) {
  return with_reason(
      absl::DataLossError(absl::StrCat("the stored chunk ", absl::BytesToHexString(digest), " ",
                                       std::string(why), "; retry the job to make it again")),
      "CHUNK_DAMAGED");
}

/// Out of the way of the next chunk of this name.
void set_aside(const fs::path& path, const std::string& why) {
  std::error_code error;
  fs::rename(path, absl::StrCat(path.string(), kDamaged), error);
  log_event(spdlog::level::err, "stored_chunk_damaged",
            {{"chunk", path.filename().string()}, {"why", why}});
}

}  // namespace

bool is_set_aside(const fs::path& path) { return path.extension() == kDamaged; }

absl::StatusOr<FolderLock> FolderLock::take(const fs::path& folder, FileLock how, bool make) {
  while (true) {
    if (make) {
      if (auto made = make_folder(folder); !made.ok()) return made;
    }
    auto file = open_file(folder / "lock", O_RDWR | O_CREAT);
    if (absl::IsNotFound(file.status()) && make) continue;
    if (!file.ok()) return file.status();
    const auto taken = file->lock(how);
    if (!taken.ok()) return taken.status();
    if (!*taken) {
      return absl::AbortedError(absl::StrCat(folder.filename().string(), " is in use"));
    }
    // The folder may have been evicted since the file was opened.
    if (!file->is_at_its_path()) continue;
    // The time of the lock's file says when the folder was used last.
    if (how == FileLock::kShared) ::futimens(file->descriptor().number(), nullptr);
    return FolderLock(*std::move(file));
  }
}

fs::path MeshFolder::chunk_path(const ChunkDigest& digest) const {
  return path_ / absl::BytesToHexString(digest);
}

fs::path MeshFolder::shard_path(ChunkRange range) const {
  return path_ / absl::StrCat("shard-", range.first, "-", range.end);
}

bool MeshFolder::has_chunk(const ChunkDigest& digest) const {
  std::error_code ignored;
  return fs::exists(chunk_path(digest), ignored);
}

absl::StatusOr<ChunkDigest> MeshFolder::put_chunk(const ChunkMessage& chunk,
                                                  const MakeRoom& make_room) {
  ChunkDigest digest = absl::HexStringToBytes(digest_of(chunk));
  if (has_chunk(digest)) return digest;
  if (make_room) {
    if (auto room = make_room(stored_bytes(chunk)); !room.ok()) return room;
  }
  const absl::Status status =
      write_whole(chunk_path(digest), [&](File& file) { return write_chunk(chunk, file); });
  if (!status.ok()) return status;
  return digest;
}

absl::StatusOr<ChunkMessage> MeshFolder::get_chunk(
    const ChunkDigest& digest,
    BlockPool& blocks,
    std::shared_ptr<SendBudget::Lease> held) const {
  const fs::path path = chunk_path(digest);
  const auto file = open_file(path, O_RDONLY);
  if (absl::IsNotFound(file.status())) return chunk_damaged(digest, "is gone");
  if (!file.ok()) return file.status();
  auto chunk = read_chunk(*file, path.filename().string(), blocks, std::move(held));
  if (!absl::IsDataLoss(chunk.status())) return chunk;
  set_aside(path, std::string(chunk.status().message()));
  return chunk_damaged(digest, "is damaged");
}

absl::Status MeshFolder::put_shard(ChunkRange range, const std::vector<ChunkDigest>& digests) {
  std::string text;
  for (const ChunkDigest& digest : digests) text += digest;
  return write_checked(shard_path(range), text);
}

std::optional<std::vector<ChunkDigest>> MeshFolder::find_shard(ChunkRange range) const {
  const auto text = read_checked(shard_path(range));
  const auto count = static_cast<std::size_t>(range.size());
  if (!text || text->size() != count * kDigestBytes) return std::nullopt;
  std::vector<ChunkDigest> digests;
  for (std::size_t i = 0; i < count; ++i) {
    digests.push_back(text->substr(i * kDigestBytes, kDigestBytes));
  }
  return digests;
}

std::optional<std::vector<ChunkDigest>> MeshFolder::find_whole_shard(ChunkRange range) const {
  auto digests = find_shard(range);
  if (!digests) return std::nullopt;
  for (const ChunkDigest& digest : *digests) {
    if (!has_chunk(digest)) return std::nullopt;
  }
  return digests;
}

}  // namespace tet
