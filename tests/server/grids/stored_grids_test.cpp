#include "server/grids/stored_grids.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tet {
namespace {

StoredGrid grid(const std::string& name) { return {{"space", name}, name, 1}; }

std::vector<std::string> oldest_first(const StoredGrids& grids) {
  std::vector<std::string> names;
  grids.oldest_first([&](const StoredGridEntry& entry) {
    names.push_back(entry.grid->key.digest);
    return true;
  });
  return names;
}

TEST(StoredGrids, WhatIsUsedLastIsUsedLastThoughTheClockWasSetBack) {
  StoredGrids grids;
  grids.put(grid("used"), absl::Now() - absl::Hours(1));
  grids.put(grid("ahead"), absl::Now() + absl::Hours(1));
  grids.put(grid("new"));
  const absl::Time seen = grids.time();
  grids.use({"space", "used"});
  EXPECT_THAT(oldest_first(grids), testing::ElementsAre("ahead", "new", "used"));
  EXPECT_LE(grids.find({"space", "ahead"})->last_use, seen) << "it may be evicted";
  EXPECT_GT(grids.find({"space", "used"})->last_use, seen) << "it was used since";
}

}  // namespace
}  // namespace tet
