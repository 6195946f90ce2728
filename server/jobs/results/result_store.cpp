#include "server/jobs/results/result_store.h"

#include <algorithm>
#include <sys/stat.h>
#include <system_error>
#include <utility>
#include <vector>

#include <absl/strings/str_cat.h>
#include <absl/time/time.h>

#include "proto/convert/status.h"
#include "server/jobs/results/whole_file.h"
#include "server/ops/disk.h"

namespace tet {

namespace fs = std::filesystem;

namespace {

constexpr char kEvicted[] = ".evicted";
constexpr char kClock[] = ".clock";
// Longer than anybody takes to write a chunk, or to make the first after a plan.
constexpr absl::Duration kUnfinishedFor = absl::Hours(1);
constexpr std::size_t kIdDigits = 64;
constexpr std::size_t kProbeBytes = 4096;

struct FoundMesh {
  fs::path path;
  std::uint64_t bytes = 0;
  absl::Time last_use;
};

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

/// What nobody will finish, and damage that was kept long enough to be looked at.
bool is_of_no_use(const fs::path& file, absl::Time now, absl::Duration keep_damaged) {
  if (is_unfinished(file)) return time_of(file) < now - kUnfinishedFor;
  return is_set_aside(file) && time_of_name(file) < now - keep_damaged;
}

/// Clears away what is of no use. Files that go while this looks are not counted: whoever
/// removes them is another process.
FoundMesh look_at(const fs::path& folder, absl::Time now, absl::Duration keep_damaged) {
  FoundMesh mesh{folder, 0, time_of(folder / "lock")};
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
        }
      }
    }
  }
  return meshes;
}

}  // namespace

absl::StatusOr<std::unique_ptr<ResultStore>> ResultStore::open(const fs::path& root,
                                                               const Limits& limits) {
  std::unique_ptr<ResultStore> store(new ResultStore(root, limits));
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
  if (!text || text->size() < kIdDigits) return std::nullopt;
  return text->substr(kIdDigits);
}

absl::Status ResultStore::reserve(std::uint64_t bytes) {
  if (auto disk = make_room_on_disk(bytes); !disk.ok()) return disk;
  const std::uint64_t budget = limits_.budget_bytes;
  if (bytes_.fetch_add(bytes) + bytes <= budget) return absl::OkStatus();
  sweep_to(budget - std::min(budget, bytes));
  if (bytes_.fetch_add(bytes) + bytes <= budget) return absl::OkStatus();
  return with_retry(
      with_reason(absl::ResourceExhaustedError(absl::StrCat(
                      "no room for ", bytes,
                      " bytes beside the results in use, of the budget of ", budget)),
                  "RESULTS_FULL"),
      absl::Seconds(5));
}

/// Evicts what it must of the results; a disk that does not tell has room.
absl::Status ResultStore::make_room_on_disk(std::uint64_t bytes) {
  const std::uint64_t wanted = bytes + limits_.keep_free_bytes;
  auto free = free_disk_bytes(root_);
  if (!free || *free >= wanted) return absl::OkStatus();
  sweep_to(limits_.budget_bytes, wanted - *free);
  free = free_disk_bytes(root_);
  if (!free || *free >= wanted) return absl::OkStatus();
  return no_disk_for(bytes, *free, limits_.keep_free_bytes);
}

absl::Status ResultStore::check_fits(std::uint64_t bytes) const {
  if (bytes > limits_.budget_bytes) {
    return over_limit("bytes of the mesh, in result_bytes", bytes, limits_.budget_bytes);
  }
  const auto free = free_disk_bytes(root_);
  if (!free) return absl::OkStatus();
  const std::uint64_t kept = limits_.keep_free_bytes;
  const std::uint64_t ours = *free + bytes_.load();
  if (ours >= kept && bytes <= ours - kept) return absl::OkStatus();
  // Our own results stop before the last of the disk: whoever took that will be seen to.
  if (*free < kept / 2) return no_disk_for(bytes, *free, kept);
  return over_limit("bytes of the mesh, on the disk of the results", bytes,
                    ours - std::min(ours, kept));
}

void ResultStore::sweep() {
  const auto free = free_disk_bytes(root_);
  const std::uint64_t kept = limits_.keep_free_bytes;
  sweep_to(limits_.budget_bytes, free && *free < kept ? kept - *free : 0);
  for (const fs::path& space : list(root_)) clear_plans(space.filename().string());
}

void ResultStore::clear_plans(const std::string& space) {
  std::error_code ignored;
  const absl::Time now = file_time_now(root_);
  for (const fs::path& file : list(root_ / space / "plans")) {
    if (time_of(file) >= now - kUnfinishedFor) continue;
    const auto text = read_checked(file);
    const bool whole = text && text->size() >= kIdDigits;
    if (whole && fs::exists(mesh_path({space, text->substr(0, kIdDigits)}), ignored)) continue;
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
void ResultStore::sweep_to(std::uint64_t budget_bytes, std::uint64_t free_bytes) {
  const std::lock_guard lock(sweeping_);
  std::vector<FoundMesh> meshes = find_meshes(root_, limits_.keep_damaged);
  std::ranges::sort(meshes, {}, &FoundMesh::last_use);
  std::uint64_t bytes = 0;
  for (const FoundMesh& mesh : meshes) bytes += mesh.bytes;
  std::uint64_t evicted = 0, freed = 0;
  for (auto it = meshes.begin(); it != meshes.end(); ++it) {
    if (bytes <= budget_bytes && freed >= free_bytes) break;
    if (!evict(it->path)) continue;
    bytes -= it->bytes;
    freed += it->bytes;
    ++evicted;
  }
  evicted_ += evicted;
  bytes_ = bytes;
  meshes_ = meshes.size() - evicted;
}

/// Under another name first: a folder of its own name is whole. False if somebody uses it.
bool ResultStore::evict(const fs::path& folder) {
  const auto lock = FolderLock::take(folder, FileLock::kAlone, false);
  if (!lock.ok()) return false;
  const fs::path away = absl::StrCat(folder.string(), kEvicted);
  std::error_code error;
  fs::rename(folder, away, error);
  if (error) return false;
  fs::remove_all(away, error);
  return true;
}

ResultStats ResultStore::stats() const {
  return {bytes_.load(), limits_.budget_bytes, meshes_.load(), evicted_.load()};
}

}  // namespace tet
