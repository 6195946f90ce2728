#include "proto/wire/chunk_frame.h"

#include <limits>
#include <numeric>
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
            std::accumulate(sizes.begin(), sizes.end(), ChunkFrame::kMaxOverhead));
  std::vector<std::byte> block(frame.block_bytes());
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    fill(frame.column(block.data(), i), static_cast<unsigned>(i) + 1);
  }
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
  chunk.set_positions(text(frame.column(block.data(), 0)));
  chunk.set_tets(text(frame.column(block.data(), 1)));
  chunk.set_regions(text(frame.column(block.data(), 2)));
  chunk.set_fields(text(frame.column(block.data(), 3)));
  chunk.set_first_face(static_cast<std::int64_t>(numbers.first_face));
  chunk.set_face_count(static_cast<std::int64_t>(numbers.face_count));
  chunk.set_faces(text(frame.column(block.data(), 4)));
  chunk.set_face_tets(text(frame.column(block.data(), 5)));
  chunk.set_face_labels(text(frame.column(block.data(), 6)));
  both.protobuf = event.SerializeAsString();
  return both;
}

TEST(ChunkFrame, IsByteForByteTheMessageThatProtobufWrites) {
  const std::uint64_t most = std::numeric_limits<std::int64_t>::max();
  const ChunkNumbers all_numbers[] = {
      {},
      {1, 2, 3, 4, 5, 6},
      {0, 127, 128, 16383, 16384, 0x80000001},
      {most, most, most, most, most, 0xffffffff, most, most},
      {0, 0, 0, 0, 0, 0, 128, 3},
  };
  const std::array<std::size_t, ChunkFrame::kColumns> all_sizes[] = {
      {0, 0, 0, 0},
      {12, 16, 0, 0},
      {12, 16, 0, 4},
      {0, 16, 1, 0},
      {127, 128, 129, 128},
      {16380, 16384, 70000, 65536},
      {12, 0, 300000, 0},
      {12, 16, 0, 0, 36, 12, 6},
      {12, 16, 1, 4, 0, 0, 2},
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
  std::vector<std::byte> block(4096);
  for (std::size_t size = 0; size < 300; ++size) {
    const ChunkFrame frame({size, size + 1, size + 2, size + 3});
    const auto misalignment = [&](std::span<const std::byte> column) {
      return (column.data() - block.data()) % std::ptrdiff_t{ChunkFrame::kAlignment};
    };
    for (std::size_t i = 0; i < ChunkFrame::kColumns; ++i) {
      EXPECT_EQ(misalignment(frame.column(block.data(), i)), 0);
    }
  }
}

}  // namespace
}  // namespace tet::test
