// How jobs are cut into shards.
#include "server/jobs/results/job_spec.h"

#include <gtest/gtest.h>

namespace tet {
namespace {

void expect_contiguous(const std::vector<ChunkRange>& ranges, std::int64_t count) {
  std::int64_t end = 0;
  for (const ChunkRange& range : ranges) {
    EXPECT_EQ(range.first, end);
    EXPECT_GT(range.size(), 0);
    end = range.end;
  }
  EXPECT_EQ(end, count);
}

TEST(JobSpec, CutsMeshesIntoContiguousShards) {
  for (const std::int64_t chunks : {1, 3, 4, 5, 100, 1024, 5'000'001}) {
    expect_contiguous(shards_of(chunks), chunks);
  }
}

TEST(JobSpec, HasAShardForEachBlockOfASurvey) {
  EXPECT_EQ(count_shards_of(3), (std::vector<ChunkRange>{{0, 1}, {1, 2}, {2, 3}}));
  EXPECT_EQ(count_shards_of(1000).size(), 1000U);
}

TEST(JobSpec, PutsManyBlocksIntoAShardRatherThanHaveTooManyShards) {
  for (const std::int64_t blocks : {1001, 131'072, 100'000'000}) {
    const auto shards = count_shards_of(blocks);
    EXPECT_LE(shards.size(), 1000U);
    EXPECT_GT(shards.size(), 500U);
    expect_contiguous(shards, blocks);
  }
}

}  // namespace
}  // namespace tet
