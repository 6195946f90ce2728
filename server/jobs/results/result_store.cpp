#include "server/jobs/results/result_store.h"

#include <algorithm>
#include <sys/stat.h>
#include <system_error>
#include <utility>
#include <vector>

#include <absl/strings/str_cat.h>
#include <absl/time/time.h>

#include "proto/convert/status.h"
#include "server/jobs/results/evict_meshes.h"
#include "server/jobs/results/whole_file.h"
#include "server/ops/disk.h"
#include "server/ops/logging.h"

namespace tet {

namespace fs = std::filesystem;

namespace {

constexpr char kClock[] = ".clock";
// Longer than anybody takes to write a chunk, or to make the first after a plan.
constexpr absl::Duration kUnfinishedFor = absl::Hours(1);
constexpr std::size_t kMeshIdDigits = 64;
constexpr std::size_t kProbeBytes = 4096;

/// There will be once others have made room.
absl::Status no_room_now(const std::string& message) {
  return with_retry(with_reason(absl::ResourceExhaustedError(message), "RESULTS_FULL"),
                    absl::Seconds(5));
}

absl::Time time_of(const fs::path& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) return absl::InfinitePast();
  return absl::TimeFromTimespec(info.st_mtim);
}

/// When it came by its name.
absl::Time time_of_name(const fs::path& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) return absl::InfiniteFuture();
  return absl::TimeFromTimespec(info.st_ctim);
}

/// The time by the clock that files get theirs of, which is another host's on a network file
/// system: that of a file which is used now. Where there is none, nothing is old.
absl::Time file_time_now(const fs::path& folder) {
  const fs::path path = folder / kClock;
  const auto file = open_file(path, O_RDWR | O_CREAT);
  if (!file.ok() || ::futimens(file->descriptor().number(), nullptr) != 0) {
    return absl::InfinitePast();
  }
  return time_of(path);
}

/// All of the disk but what is to stay free; a disk that does not tell has no end.
std::uint64_t most_on_disk(const fs::path& folder, std::uint64_t kept) {
  const auto whole = whole_disk_bytes(folder);
  return whole ? *whole - std::min(*whole, kept) : UINT64_MAX;
}

/// What nobody will finish, and damage that was kept long enough to be looked at.
bool is_of_no_use(const fs::path& file, absl::Time now, absl::Duration keep_damaged) {
  if (is_unfinished(file)) return time_of(file) < now - kUnfinishedFor;
  return is_set_aside(file) && time_of_name(file) < now - keep_damaged;
}

/// Clears away what is of no use. Files that go while this looks are not counted: whoever
/// removes them is another process.
FoundMesh look_at(const fs::path& folder, absl::Time now, absl::Duration keep_damaged) {
  FoundMesh mesh{{}, folder, 0, time_of(folder / "lock")};
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end;
       it.increment(error)) {
    std::error_code gone;
    if (is_of_no_use(it->path(), now, keep_damaged)) {
      fs::remove(it->path(), gone);
      continue;
    }
    const std::uint64_t size = it->file_size(gone);
    if (!gone) mesh.bytes += size;
  }
  return mesh;
}

/// Folders and files directly in `folder`; none where it is gone.
std::vector<fs::path> list(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end;
       it.increment(error)) {
    found.push_back(it->path());
  }
  return found;
}

/// All meshes; what somebody died over while evicting it is removed.
std::vector<FoundMesh> find_meshes(const fs::path& root, absl::Duration keep_damaged) {
  std::vector<FoundMesh> meshes;
  const absl::Time now = file_time_now(root);
  for (const fs::path& space : list(root)) {
    for (const fs::path& shelf : list(space / "meshes")) {
      for (const fs::path& folder : list(shelf)) {
        std::error_code ignored;
        if (folder.extension() == kEvicted) {
          fs::remove_all(folder, ignored);
        } else {
          meshes.push_back(look_at(folder, now, keep_damaged));
          meshes.back().key = {space.filename().string(), folder.filename().string()};
        }
      }
    }
  }
  return meshes;
}

}  // namespace

absl::StatusOr<std::unique_ptr<ResultStore>> ResultStore::open(const fs::path& root,
                                                               const Limits& limits,
                                                               Needed needed) {
  std::unique_ptr<ResultStore> store(new ResultStore(root, limits, std::move(needed)));
  store->sweep();
  return store;
}

fs::path ResultStore::mesh_path(const ResultKey& key) const {
  return root_ / key.space / "meshes" / key.mesh_id.substr(0, 2) / key.mesh_id;
}

fs::path ResultStore::plan_path(const std::string& space, const std::string& name) const {
  return root_ / space / "plans" / name;
}

absl::StatusOr<std::shared_ptr<MeshFolder>> ResultStore::make(const ResultKey& key) {
  auto lock = FolderLock::take(mesh_path(key), FileLock::kShared, true);
  if (!lock.ok()) return lock.status();
  return std::make_shared<MeshFolder>(mesh_path(key), *std::move(lock));
}

absl::StatusOr<std::shared_ptr<MeshFolder>> ResultStore::find(const ResultKey& key) const {
  auto lock = FolderLock::take(mesh_path(key), FileLock::kShared, false);
  if (!lock.ok()) return lock.status();
  return std::make_shared<MeshFolder>(mesh_path(key), *std::move(lock));
}

// A plan begins with its mesh's id, so that whoever clears away need not understand it.
absl::Status ResultStore::put_plan(const ResultKey& mesh,
                                   const std::string& name,
                                   const std::string& text) {
  const fs::path path = plan_path(mesh.space, name);
  const absl::Status made = make_folder(path.parent_path());
  return made.ok() ? write_checked(path, mesh.mesh_id + text) : made;
}

std::optional<std::string> ResultStore::find_plan(const std::string& space,
                                                  const std::string& name) const {
  auto text = read_checked(plan_path(space, name));
  if (!text || text->size() < kMeshIdDigits) return std::nullopt;
  return text->substr(kMeshIdDigits);
}

void ResultStore::keep_plan(const std::string& space, const std::string& name) const {
  ::utimensat(AT_FDCWD, plan_path(space, name).c_str(), nullptr, 0);
}

/// Room that is in the account; given back unless it was used.
class ResultStore::Room {
 public:
  Room(ResultStore& store, std::uint64_t bytes, File writing)
      : store_(store), bytes_(bytes), writing_(std::move(writing)) {}
  ~Room() {
    if (!used_) store_.give_back(bytes_);
  }
  Room(const Room&) = delete;
  Room& operator=(const Room&) = delete;

  void use() { used_ = true; }

 private:
  ResultStore& store_;
  const std::uint64_t bytes_;
  const File writing_;  ///< nobody counts as long as it is open
  bool used_ = false;
};

absl::StatusOr<PutChunk> ResultStore::put_chunk(MeshFolder& folder, const ChunkMessage& chunk) {
  std::unique_ptr<Room> room;
  auto digest = folder.put_chunk(chunk, [&](std::uint64_t bytes) -> absl::Status {
    auto reserved = reserve(bytes);
    if (reserved.ok()) room = std::move(*reserved);
    return reserved.status();
  });
  if (!digest.ok()) return digest.status();
  if (room != nullptr) room->use();
  return PutChunk{*std::move(digest), room != nullptr};
}

absl::StatusOr<std::unique_ptr<ResultStore::Room>> ResultStore::reserve(std::uint64_t bytes) {
  if (auto disk = make_room_on_disk(bytes); !disk.ok()) return disk;
  auto turn = ledger_.take();
  if (!turn.ok()) return turn.status();
  const std::uint64_t budget = limits_.budget_bytes;
  const auto counted = turn->total();
  bytes_ = counted.value_or(0);
  if (!counted || *counted > budget || bytes > budget - *counted) {
    const absl::Status swept = sweep_in(*turn, budget - std::min(budget, bytes));
    if (!swept.ok()) return swept;
  }
  const std::uint64_t total = bytes_;
  if (total > budget || bytes > budget - total) {
    return no_room_now(
        absl::StrCat("no room for ", bytes,
                     " bytes beside the results in use and those that unfinished jobs ",
                     "need, of the budget of ", budget));
  }
  auto writing = turn->join_writers();
  if (!writing.ok()) return writing.status();
  if (auto set = turn->set(total + bytes); !set.ok()) return set;
  bytes_ = total + bytes;
  return std::make_unique<Room>(*this, bytes, *std::move(writing));
}

/// Where the account cannot be had, what was not written stays in it until it is counted anew.
void ResultStore::give_back(std::uint64_t bytes) {
  auto turn = ledger_.take();
  if (!turn.ok()) return;
  const std::uint64_t total = turn->total().value_or(0);
  if (turn->set(total - std::min(total, bytes)).ok()) bytes_ = total - std::min(total, bytes);
}

/// Evicts what it must of the results; a disk that does not tell has room.
absl::Status ResultStore::make_room_on_disk(std::uint64_t bytes) {
  const std::uint64_t wanted = bytes + limits_.keep_free_bytes;
  auto free = free_disk_bytes(root_);
  if (!free || *free >= wanted) return absl::OkStatus();
  const absl::Status swept = sweep_to(limits_.budget_bytes, wanted - *free);
  if (!swept.ok()) return swept;
  free = free_disk_bytes(root_);
  if (!free || *free >= wanted) return absl::OkStatus();
  return no_disk_for(bytes, *free, limits_.keep_free_bytes);
}

absl::Status ResultStore::check_ever_fits(std::uint64_t bytes) const {
  if (bytes > limits_.budget_bytes) {
    return over_limit("bytes of the mesh, in result_bytes", bytes, limits_.budget_bytes);
  }
  const std::uint64_t most = most_on_disk(root_, limits_.keep_free_bytes);
  if (bytes <= most) return absl::OkStatus();
  return over_limit("bytes of the mesh, on the disk of the results", bytes, most);
}

absl::Status ResultStore::check_fits(std::uint64_t bytes) {
  if (auto ever = check_ever_fits(bytes); !ever.ok()) return ever;
  const auto free = free_disk_bytes(root_);
  if (!free) return absl::OkStatus();
  const std::uint64_t ours = *free + count_bytes();
  const std::uint64_t room = ours - std::min(ours, limits_.keep_free_bytes);
  if (bytes <= room) return absl::OkStatus();
  return no_room_now(absl::StrCat("no room for the mesh's ", bytes,
                                  " bytes on the disk of the results now: ", room,
                                  " are free or can be made so, and others hold the rest of ",
                                  most_on_disk(root_, limits_.keep_free_bytes)));
}

/// What all processes have stored by now, as far as it can be asked.
std::uint64_t ResultStore::count_bytes() {
  if (const auto turn = ledger_.take(); turn.ok()) bytes_ = turn->total().value_or(bytes_);
  return bytes_;
}

void ResultStore::sweep() {
  const auto free = free_disk_bytes(root_);
  const std::uint64_t kept = limits_.keep_free_bytes;
  const absl::Status swept =
      sweep_to(limits_.budget_bytes, free && *free < kept ? kept - *free : 0);
  if (!swept.ok() && !absl::IsNotFound(swept)) {
    log_event(spdlog::level::warn, "results_not_swept",
              {{"message", std::string(swept.message())}});
  }
  for (const fs::path& space : list(root_)) clear_plans(space.filename().string());
}

void ResultStore::clear_plans(const std::string& space) {
  std::error_code ignored;
  const absl::Time now = file_time_now(root_);
  for (const fs::path& file : list(root_ / space / "plans")) {
    if (time_of(file) >= now - kUnfinishedFor) continue;
    const auto text = read_checked(file);
    const bool whole = text && text->size() >= kMeshIdDigits;
    if (whole && fs::exists(mesh_path({space, text->substr(0, kMeshIdDigits)}), ignored))
      continue;
    fs::remove(file, ignored);
  }
}

absl::Status ResultStore::probe() const {
  const fs::path path = root_ / ".probe";
  if (absl::Status made = make_folder(root_); !made.ok()) return made;
  const absl::Status written = write_checked(path, std::string(kProbeBytes, '.'));
  std::error_code ignored;
  fs::remove(path, ignored);
  return written;
}

/// Evicts until at most `budget_bytes` are stored and `free_bytes` of the disk have become
/// free.
absl::Status ResultStore::sweep_to(std::uint64_t budget_bytes, std::uint64_t free_bytes) {
  auto turn = ledger_.take();
  return turn.ok() ? sweep_in(*turn, budget_bytes, free_bytes) : turn.status();
}

/// What others are writing is in the account, and may not be seen yet: as long as anybody
/// writes, the account is right where it has more than is seen.
absl::Status ResultStore::sweep_in(ResultLedger::Turn& turn,
                                   std::uint64_t budget_bytes,
                                   std::uint64_t free_bytes) {
  const auto quiet = turn.is_quiet();
  if (!quiet.ok()) return quiet.status();
  std::vector<FoundMesh> meshes = find_meshes(root_, limits_.keep_damaged);
  std::ranges::sort(meshes, {}, &FoundMesh::last_use);
  std::uint64_t bytes = 0;
  for (const FoundMesh& mesh : meshes) bytes += mesh.bytes;
  if (!*quiet) bytes = std::max(bytes, turn.total().value_or(0));
  const std::uint64_t surplus = bytes - std::min(bytes, budget_bytes);
  const Evicted evicted = evict_meshes(meshes, std::max(surplus, free_bytes), needed_);
  evicted_ += evicted.meshes;
  bytes_ = bytes - std::min(bytes, evicted.bytes);
  meshes_ = meshes.size() - evicted.meshes;
  const absl::Status set = turn.set(bytes_);
  return evicted.status.ok() ? set : evicted.status;
}

ResultStats ResultStore::stats() const {
  return {bytes_.load(), limits_.budget_bytes, meshes_.load(), evicted_.load()};
}

}  // namespace tet
