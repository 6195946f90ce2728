#include "server/grids/volume_cache.h"

#include <algorithm>
#include <utility>

#include <absl/strings/str_cat.h>

#include "core/base/contain.h"
#include "proto/convert/status.h"

namespace tet {
namespace {

std::uint64_t bytes_of(const GridInMemory& grid) {
  return std::visit([](const auto& held) { return std::uint64_t{held->size_bytes()}; }, grid);
}

bool is_in_use(const GridInMemory& grid) {
  return std::visit([](const auto& held) { return held.use_count() != 1; }, grid);
}

}  // namespace

VolumeCache::VolumeCache(FairTasks& tasks,
                         std::uint64_t budget_bytes,
                         Loader loader,
                         std::function<void()> release)
    : tasks_(tasks),
      budget_bytes_(budget_bytes),
      loader_(std::move(loader)),
      release_(std::move(release)) {}

/// Tells how a load ended, once: where nobody does, that it failed. What is thrown anywhere on
/// its way, as for want of memory, must leave nobody waiting, neither now nor later.
class VolumeCache::Ending {
 public:
  Ending(VolumeCache& cache, Load load) : cache_(cache), load_(std::move(load)) {}
  ~Ending() {
    if (!told_) contain("loading a grid", [this] { tell(lost()); });
  }
  Ending(const Ending&) = delete;
  Ending& operator=(const Ending&) = delete;

  void tell(Loaded read) {
    cache_.finish_load(load_, std::move(read));
    told_ = true;
  }

  static absl::Status lost() {
    return absl::InternalError("the server failed in reading the file");
  }

 private:
  VolumeCache& cache_;
  const Load load_;
  bool told_ = false;
};

void VolumeCache::get(const VolumeKey& key, const std::string& path, Request request) {
  const Load wanted{key, path, request.client};
  {
    const std::lock_guard lock(mutex_);
    Entry& entry = entries_[key];
    entry.last_use = ++clock_;
    if (entry.grid) {
      tasks_.post(request.client,
                  [answer = std::move(request.answer), grid = *entry.grid] { answer(grid); });
      return;
    }
    // It is being loaded while anybody waits for it.
    entry.waiting.push_back(std::move(request));
    if (entry.waiting.size() > 1) return;
  }
  load(wanted);
}

void VolumeCache::load(const Load& load) {
  std::shared_ptr<Ending> ending;
  contain("loading a grid", [&] {
    ending = std::make_shared<Ending>(*this, load);
    loader_(
        load, [this, key = load.key] { return is_abandoned(key); },
        [ending](Loaded read) { ending->tell(std::move(read)); });
  });
  if (ending == nullptr) {
    contain("loading a grid", [&] { finish_load(load, Ending::lost()); });
  }
}

bool VolumeCache::is_abandoned(const VolumeKey& key) {
  const std::lock_guard lock(mutex_);
  const auto entry = entries_.find(key);
  if (entry == entries_.end()) return true;
  const auto& waiting = entry->second.waiting;
  return std::all_of(waiting.begin(), waiting.end(),
                     [](const Request& request) { return request.cancelled(); });
}

void VolumeCache::finish_load(const Load& wanted, Loaded read) {
  const VolumeKey& key = wanted.key;
  // Somebody may have come just when the others had gone.
  if (absl::IsCancelled(read.status()) && !is_abandoned(key)) return load(wanted);
  const Loaded loaded = read.ok() ? admit(key, *read) : read.status();
  read = absl::UnknownError("handed on");  // what nobody holds can be evicted

  const std::lock_guard lock(mutex_);
  const auto entry = entries_.find(key);
  if (entry == entries_.end()) return;  // it was told already, as far as that went
  std::vector<Request> waiting = std::exchange(entry->second.waiting, {});
  if (!loaded.ok()) entries_.erase(entry);
  for (Request& request : waiting) {
    tasks_.post(request.client,
                [answer = std::move(request.answer), loaded] { answer(loaded); });
  }
}

/// Makes room for a volume that has just been read, and puts it there.
VolumeCache::Loaded VolumeCache::admit(const VolumeKey& key, const GridInMemory& grid) {
  const std::uint64_t size = bytes_of(grid);
  const std::string what = absl::StrCat("grid \"", key.grid_name, "\" in memory, bytes");
  if (size > budget_bytes_) return over_limit(what, size, budget_bytes_);
  const auto fits = [&] {
    const std::lock_guard lock(mutex_);
    while (used_bytes() + size > budget_bytes_) {
      if (!evict_oldest()) return false;
    }
    entries_[key].grid = grid;
    return true;
  };
  if (fits()) return grid;
  release_();
  if (fits()) return grid;
  refused_.note();
  return with_retry(over_limit(absl::StrCat(what, " beside those in use"), size, budget_bytes_),
                    absl::Seconds(5));
}

CacheStats VolumeCache::stats() const {
  const std::lock_guard lock(mutex_);
  return {used_bytes(), budget_bytes_, entries_.size(), evicted_};
}

std::uint64_t VolumeCache::used_bytes() const {
  std::uint64_t used = 0;
  for (const auto& [key, entry] : entries_) {
    if (entry.grid) used += bytes_of(*entry.grid);
  }
  return used;
}

bool VolumeCache::evict_oldest() {
  auto oldest = entries_.end();
  for (auto it = entries_.begin(); it != entries_.end(); ++it) {
    if (!it->second.grid || is_in_use(*it->second.grid)) continue;
    if (oldest == entries_.end() || it->second.last_use < oldest->second.last_use) oldest = it;
  }
  if (oldest == entries_.end()) return false;
  entries_.erase(oldest);
  ++evicted_;
  return true;
}

}  // namespace tet
