// The whole files of a grid store: by key, by their last use, and what they take together.
#pragma once

#include <compare>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>

#include <absl/time/time.h>

#include "core/base/posix/file.h"

namespace tet {

/// Whose file, and which: the same bytes in two namespaces are two files, so that neither tells
/// anything of the other.
struct GridKey {
  std::string space;
  std::string digest;
  friend auto operator<=>(const GridKey&, const GridKey&) = default;
};

/// A whole, verified file. It is not evicted while anyone holds a lease on it.
struct StoredGrid {
  GridKey key;
  std::filesystem::path path;
  std::uint64_t size_bytes = 0;
};
using GridLease = std::shared_ptr<const StoredGrid>;

/// What a store knows of one of its files.
struct StoredGridEntry {
  std::shared_ptr<StoredGrid> grid;
  absl::Time last_use;
  std::uint64_t last_lease = 0;  ///< the store's count of leases when it was given out last
  std::weak_ptr<const File> file =
      {};  ///< open and locked while it is leased, in shared stores
  bool in_use() const { return grid.use_count() > 1; }
};

/// A store may hold a million small files, and every upload asks for their sum and, once the
/// store is full, for the oldest: neither reads them all. Not thread-safe.
class StoredGrids {
 public:
  using ByKey = std::map<GridKey, StoredGridEntry>;

  const ByKey& by_key() const { return by_key_; }
  std::uint64_t bytes() const { return bytes_; }

  bool contains(const GridKey& key) const { return by_key_.contains(key); }
  /// Null without one.
  const StoredGridEntry* find(const GridKey& key) const;

  /// Takes the place of one that is there; without a time it was used just now.
  void put(StoredGrid grid, absl::Time last_use);
  void put(StoredGrid grid);
  void erase(const GridKey& key);
  /// It was used just now. It must be there.
  void use(const GridKey& key);
  /// It was used then, as its file says.
  void set_use(const GridKey& key, absl::Time time);
  void hold(const GridKey& key, const std::shared_ptr<const File>& file);
  void lease(const GridKey& key, std::uint64_t number);

  /// Now, and never before any use so far, as the clock may have been set back since.
  absl::Time time() const;

  /// Calls `see` with one file after another, those first that were used least recently, until
  /// it returns false.
  template <class See>
  void oldest_first(See see) const {
    for (const auto& [time, key] : by_use_) {
      if (!see(by_key_.at(*key))) return;
    }
  }

 private:
  absl::Time time_of_next_use() const;

  ByKey by_key_;
  std::set<std::pair<absl::Time, const GridKey*>> by_use_;  ///< keys of by_key_
  std::uint64_t bytes_ = 0;
};

}  // namespace tet
