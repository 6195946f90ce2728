#include "proto/wire/chunk_frame.h"

#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tetstream/v1/meshes.pb.h"

namespace tet::test {
namespace {

namespace v1 = ::tetstream::v1;

std::string text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void fill(std::span<std::byte> column, unsigned seed) {
  for (std::size_t i = 0; i < column.size(); ++i)
    column[i] = static_cast<std::byte>(i * 7 + seed);
}

/// The message that a frame makes around columns of these sizes, and protobuf's own.
struct BothMessages {
  std::string framed, protobuf;
};

BothMessages messages_of(const ChunkNumbers& numbers,
                         std::array<std::size_t, ChunkFrame::kColumns> sizes) {
  const ChunkFrame frame(sizes);
  EXPECT_LE(frame.block_bytes(),
            sizes[0] + sizes[1] + sizes[2] + sizes[3] + ChunkFrame::kMaxOverhead);
  std::vector<std::byte> block(frame.block_bytes());
  fill(frame.positions(block.data()), 1);
  fill(frame.tets(block.data()), 2);
  fill(frame.regions(block.data()), 3);
  fill(frame.fields(block.data()), 4);
  BothMessages both;
  for (const auto& part : frame.write(block.data(), numbers)) {
    both.framed += text(std::span(block).subspan(part.begin, part.end - part.begin));
  }
  v1::MeshEvent event;
  v1::MeshChunk& chunk = *event.mutable_chunk();
  chunk.set_index(static_cast<std::int64_t>(numbers.index));
  chunk.set_first_vertex(static_cast<std::int64_t>(numbers.first_vertex));
  chunk.set_vertex_count(static_cast<std::int64_t>(numbers.vertex_count));
  chunk.set_first_tet(static_cast<std::int64_t>(numbers.first_tet));
  chunk.set_tet_count(static_cast<std::int64_t>(numbers.tet_count));
  chunk.set_checksum(numbers.checksum);
  chunk.set_positions(text(frame.positions(block.data())));
  chunk.set_tets(text(frame.tets(block.data())));
  chunk.set_regions(text(frame.regions(block.data())));
  chunk.set_fields(text(frame.fields(block.data())));
  both.protobuf = event.SerializeAsString();
  return both;
}

TEST(ChunkFrame, IsByteForByteTheMessageThatProtobufWrites) {
  const std::uint64_t most = std::numeric_limits<std::int64_t>::max();
  const ChunkNumbers all_numbers[] = {
      {},
      {1, 2, 3, 4, 5, 6},
      {0, 127, 128, 16383, 16384, 0x80000001},
      {most, most, most, most, most, 0xffffffff},
  };
  const std::array<std::size_t, ChunkFrame::kColumns> all_sizes[] = {
      {0, 0, 0, 0},       {12, 16, 0, 0},       {12, 16, 0, 4},
      {0, 16, 1, 0},      {127, 128, 129, 128}, {16380, 16384, 70000, 65536},
      {12, 0, 300000, 0},
  };
  for (const ChunkNumbers& numbers : all_numbers) {
    for (const auto& sizes : all_sizes) {
      const BothMessages both = messages_of(numbers, sizes);
      EXPECT_TRUE(both.framed == both.protobuf)
          << "index " << numbers.index << ", columns of " << sizes[0] << ", " << sizes[1]
          << ", " << sizes[2] << " and " << sizes[3] << " bytes";
    }
  }
}

TEST(ChunkFrame, KeepsColumnsAlignedWhateverComesBefore) {
  std::vector<std::byte> block(2048);
  for (std::size_t size = 0; size < 300; ++size) {
    const ChunkFrame frame({size, size + 1, size + 2, size + 3});
    const auto misalignment = [&](std::span<const std::byte> column) {
      return (column.data() - block.data()) % std::ptrdiff_t{ChunkFrame::kAlignment};
    };
    EXPECT_EQ(misalignment(frame.positions(block.data())), 0);
    EXPECT_EQ(misalignment(frame.tets(block.data())), 0);
    EXPECT_EQ(misalignment(frame.regions(block.data())), 0);
    EXPECT_EQ(misalignment(frame.fields(block.data())), 0);
  }
}

}  // namespace
}  // namespace tet::test
