#include "server/grids/stored_grids.h"

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

void StoredGrids::erase(const GridKey& key) {
  const auto found = by_key_.find(key);
  if (found == by_key_.end()) return;
  bytes_ -= found->second.grid->size_bytes;
  by_use_.erase({found->second.last_use, &found->first});
  by_key_.erase(found);
}

void StoredGrids::use(const GridKey& key) {
  const auto found = by_key_.find(key);
  by_use_.erase({found->second.last_use, &found->first});
  found->second.last_use = absl::Now();
  by_use_.emplace(found->second.last_use, &found->first);
}

void StoredGrids::lease(const GridKey& key, std::uint64_t number) {
  by_key_.find(key)->second.last_lease = number;
}

}  // namespace tet
