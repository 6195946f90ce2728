// Chunks as messages, and those that nobody waits for any more.
#include "server/meshing/chunk_maker.h"

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <grpcpp/support/slice.h>
#include <gtest/gtest.h>

#include "core/plan/make/plan_mesh.h"
#include "proto/wire/chunk_frame.h"
#include "tests/support/counted_looks.h"
#include "tests/support/solids.h"

namespace tet {
namespace {

using test::CountedLooks;

std::string bytes_of(const grpc::ByteBuffer& message) {
  std::vector<grpc::Slice> slices;
  EXPECT_TRUE(message.Dump(&slices).ok());
  std::string bytes;
  for (const grpc::Slice& slice : slices) {
    bytes.append(reinterpret_cast<const char*>(slice.begin()), slice.size());
  }
  return bytes;
}

constexpr std::size_t kBlockBytes = kChunkBytes + ChunkFrame::kMaxOverhead;

/// Makes the first chunk of a ball's mesh, again and again in the same memory.
class ChunkMaker : public testing::TestWithParam<v1::Encoding> {
 protected:
  absl::StatusOr<ChunkMessage> make(const Cancellation& cancellation) {
    std::shared_ptr<SendBudget::Lease> held;
    budget_.ask(this, "client", [&](auto lease) { held = std::move(lease); });
    return make_chunk(source_, 0, {workspaces_, packers_, blocks_}, std::move(held),
                      cancellation);
  }

  ScratchPool<MeshWorkspace> workspaces_;
  ScratchPool<ChunkPacker> packers_;
  SendBudget budget_{4 * kBlockBytes, kBlockBytes};
  BlockPool blocks_{kBlockBytes, 4};
  const ChunkSource source_{
      *plan_mesh({.shape = std::make_shared<const Volume>(test::ball(20)), .request = {}}),
      nullptr, GetParam()};
};

TEST_P(ChunkMaker, HandsOutNothingOfAChunkThatIsNoLongerWanted) {
  CountedLooks never;
  const auto whole = make(never.cancellation);
  ASSERT_TRUE(whole.ok()) << whole.status();
  ASSERT_GT(never.looks, 20U);
  for (std::size_t at = 0; at < never.looks; ++at) {
    CountedLooks cut{at};
    EXPECT_EQ(make(cut.cancellation).status().code(), absl::StatusCode::kCancelled) << at;
  }
  const auto again = make(Cancellation());
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(bytes_of(again->event), bytes_of(whole->event));
}

TEST_P(ChunkMaker, GivesTheBlockOfSuchAChunkBack) {
  CountedLooks cut{5};
  EXPECT_FALSE(make(cut.cancellation).ok());
  EXPECT_EQ(budget_.used_bytes(), 0U);
}

INSTANTIATE_TEST_SUITE_P(OfEveryEncoding,
                         ChunkMaker,
                         testing::Values(v1::ENCODING_PLAIN,
                                         v1::ENCODING_PACKED,
                                         v1::ENCODING_COMPACT));

}  // namespace
}  // namespace tet
