#include "proto/wire/block_pool.h"

#include <memory>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

namespace tet::test {
namespace {

constexpr std::size_t kBlock = 4096;

TEST(BlockPool, UsesABlockAgainOnceItsLastSliceIsGone) {
  BlockPool pool(kBlock, 2);
  std::optional<grpc::Slice> whole = pool.take(kBlock);
  const void* const place = whole->begin();
  std::optional<grpc::Slice> part = whole->sub(64, kBlock);
  whole.reset();
  EXPECT_EQ(pool.idle(), 0U);
  part.reset();
  EXPECT_EQ(pool.idle(), 1U);
  EXPECT_EQ(pool.take(100).begin(), place);
}

TEST(BlockPool, HoldsNoMoreThanItMay) {
  BlockPool pool(kBlock, 2);
  {
    std::vector<grpc::Slice> slices;
    for (int i = 0; i < 5; ++i) slices.push_back(pool.take(kBlock));
  }
  EXPECT_EQ(pool.idle(), 2U);
}

TEST(BlockPool, GivesWhatIsLargerThanItsBlocksAndDoesNotKeepIt) {
  BlockPool pool(kBlock, 2);
  EXPECT_EQ(pool.take(10 * kBlock).size(), 10 * kBlock);
  EXPECT_EQ(pool.idle(), 0U);
}

TEST(BlockPool, GivesAlignedMemoryOfTheSizeAsked) {
  BlockPool pool(kBlock, 2);
  for (const std::size_t size : {std::size_t{1}, std::size_t{1000}, kBlock, kBlock + 1}) {
    const grpc::Slice slice = pool.take(size);
    EXPECT_EQ(slice.size(), size);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(slice.begin()) % 64, 0U);
  }
}

TEST(BlockPool, MayEndBeforeItsBlocksComeBack) {
  auto pool = std::make_unique<BlockPool>(kBlock, 2);
  const grpc::Slice slice = pool->take(kBlock);
  pool.reset();
  EXPECT_EQ(slice.size(), kBlock);
}

}  // namespace
}  // namespace tet::test
