#include "server/grids/stored_grids.h"

#include <algorithm>

#include <absl/time/clock.h>

namespace tet {

const StoredGridEntry* StoredGrids::find(const GridKey& key) const {
  const auto found = by_key_.find(key);
  return found == by_key_.end() ? nullptr : &found->second;
}

void StoredGrids::put(StoredGrid grid, absl::Time last_use) {
  erase(grid.key);
  bytes_ += grid.size_bytes;
  const GridKey key = grid.key;
  const auto [added, is_new] = by_key_.emplace(
      key, StoredGridEntry{std::make_shared<StoredGrid>(std::move(grid)), last_use});
  by_use_.emplace(last_use, &added->first);
}

void StoredGrids::put(StoredGrid grid) {
  const absl::Time now = time_of_next_use();
  put(std::move(grid), now);
}

absl::Time StoredGrids::time() const {
  const absl::Time now = absl::Now();
  return by_use_.empty() ? now : std::max(now, by_use_.rbegin()->first);
}

/// What is used now is used last, whatever the clock says.
absl::Time StoredGrids::time_of_next_use() const {
  const absl::Time now = absl::Now();
  return by_use_.empty() ? now : std::max(now, by_use_.rbegin()->first + absl::Nanoseconds(1));
}

void StoredGrids::erase(const GridKey& key) {
  const auto found = by_key_.find(key);
  if (found == by_key_.end()) return;
  bytes_ -= found->second.grid->size_bytes;
  by_use_.erase({found->second.last_use, &found->first});
  by_key_.erase(found);
}

void StoredGrids::use(const GridKey& key) { set_use(key, time_of_next_use()); }

void StoredGrids::set_use(const GridKey& key, absl::Time time) {
  const auto found = by_key_.find(key);
  by_use_.erase({found->second.last_use, &found->first});
  found->second.last_use = time;
  by_use_.emplace(found->second.last_use, &found->first);
}

void StoredGrids::hold(const GridKey& key, const std::shared_ptr<const File>& file) {
  by_key_.find(key)->second.file = file;
}

void StoredGrids::lease(const GridKey& key, std::uint64_t number) {
  by_key_.find(key)->second.last_lease = number;
}

}  // namespace tet
