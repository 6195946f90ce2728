#include "server/streams/frame_leaves.h"

#include <atomic>
#include <cstdint>
#include <malloc.h>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace tet {
namespace {

constexpr int kLeaves = 1000;

v1::LeafUpdate constant_leaf(int i) {
  v1::LeafUpdate leaf;
  leaf.set_x(8 * i);
  leaf.set_values(std::string(sizeof(float), '\0'));
  return leaf;
}

/// What is charged for those messages.
std::uint64_t charged_for(const std::vector<v1::RemeshFrame>& messages) {
  std::atomic<std::uint64_t> all{0};
  FrameLeaves leaves("", std::make_shared<CallCharge>("leaves", all, UINT64_MAX));
  for (const v1::RemeshFrame& message : messages) {
    EXPECT_EQ(leaves.add(message), absl::OkStatus());
  }
  EXPECT_EQ(leaves.leaves().size(), std::size_t{kLeaves});
  return all;
}

TEST(FrameLeaves, KeepNothingOfAMessageWithoutLeaves) {
  std::atomic<std::uint64_t> all{0};
  FrameLeaves leaves("", std::make_shared<CallCharge>("leaves", all, UINT64_MAX));
  const std::size_t before = ::mallinfo2().uordblks + ::mallinfo2().hblkhd;
  for (int i = 0; i < 1'000'000; ++i) ASSERT_EQ(leaves.add({}), absl::OkStatus());
  const std::size_t after = ::mallinfo2().uordblks + ::mallinfo2().hblkhd;
  EXPECT_LT(after, before + (std::size_t{4} << 20));
  EXPECT_EQ(all, 0U);
}

TEST(FrameLeaves, AreChargedForEachMessageToo) {
  std::vector<v1::RemeshFrame> at_once(1), one_by_one(kLeaves);
  for (int i = 0; i < kLeaves; ++i) {
    *at_once[0].add_leaves() = *one_by_one[static_cast<std::size_t>(i)].add_leaves() =
        constant_leaf(i);
  }
  EXPECT_GE(charged_for(one_by_one),
            charged_for(at_once) + kLeaves * sizeof(std::vector<float>));
}

}  // namespace
}  // namespace tet
