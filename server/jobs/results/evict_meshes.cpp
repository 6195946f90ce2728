#include "server/jobs/results/evict_meshes.h"

#include <set>
#include <system_error>
#include <utility>
#include <vector>

#include <absl/strings/str_cat.h>

namespace tet {

namespace fs = std::filesystem;

namespace {

/// A mesh that nobody uses, nor may use as long as this is there.
struct Candidate {
  const FoundMesh* mesh;
  FolderLock lock;
};

/// Locks that are held at once: each is an open file, and whoever wants one of the meshes waits
/// while it is asked what is needed.
constexpr std::size_t kLockedAtOnce = 64;

/// Takes from the front of `meshes` some, or what would be enough if nobody needed it.
std::vector<Candidate> lock_some(std::span<const FoundMesh>& meshes,
                                 std::uint64_t bytes,
                                 const std::set<ResultKey>& needed) {
  std::vector<Candidate> locked;
  for (std::uint64_t found = 0;
       !meshes.empty() && found < bytes && locked.size() < kLockedAtOnce;) {
    const FoundMesh& mesh = meshes.front();
    meshes = meshes.subspan(1);
    if (needed.contains(mesh.key)) continue;
    auto lock = FolderLock::take(mesh.path, FileLock::kAlone, false);
    if (!lock.ok()) continue;
    locked.push_back({&mesh, *std::move(lock)});
    found += mesh.bytes;
  }
  return locked;
}

/// Under another name first: a folder of its own name is whole.
bool take_away(const fs::path& folder) {
  const fs::path away = absl::StrCat(folder.string(), kEvicted);
  std::error_code error;
  fs::rename(folder, away, error);
  if (error) return false;
  fs::remove_all(away, error);
  return true;
}

}  // namespace

Evicted evict_meshes(std::span<const FoundMesh> meshes,
                     std::uint64_t bytes,
                     const ResultStore::Needed& needed) {
  Evicted evicted;
  std::set<ResultKey> spared;
  while (evicted.bytes < bytes) {
    const auto candidates = lock_some(meshes, bytes - evicted.bytes, spared);
    if (candidates.empty()) return evicted;
    // A shard is made under its mesh's lock, once its job was planned. So a job that has made
    // something of these is known to whoever is asked while we have their locks.
    auto told = needed ? needed() : std::set<ResultKey>();
    if (!told.ok()) {
      evicted.status = told.status();
      return evicted;
    }
    spared = *std::move(told);
    for (const Candidate& candidate : candidates) {
      const FoundMesh& mesh = *candidate.mesh;
      if (spared.contains(mesh.key) || !take_away(mesh.path)) continue;
      evicted.bytes += mesh.bytes;
      ++evicted.meshes;
    }
  }
  return evicted;
}

}  // namespace tet
