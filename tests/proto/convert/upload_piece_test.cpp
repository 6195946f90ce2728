#include "proto/convert/upload_piece.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "proto/wire/upload_frame.h"
#include "tetstream/v1/grids.pb.h"

namespace tet::test {
namespace {

namespace v1 = ::tetstream::v1;

grpc::ByteBuffer in_slices(std::string_view bytes, std::size_t slice_bytes) {
  std::vector<grpc::Slice> slices;
  for (; !bytes.empty(); bytes.remove_prefix(std::min(slice_bytes, bytes.size()))) {
    slices.emplace_back(std::string(bytes.substr(0, slice_bytes)));
  }
  return {slices.data(), slices.size()};
}

std::string message_of(std::uint64_t offset, const std::string& bytes) {
  v1::UploadGridRequest message;
  message.mutable_data()->set_offset(static_cast<std::int64_t>(offset));
  message.mutable_data()->set_data(bytes);
  return message.SerializeAsString();
}

std::string joined(const UploadPiece& piece) {
  std::string all;
  for (const std::string_view part : piece.bytes) all += part;
  return all;
}

TEST(UploadPiece, IsReadHoweverItWasSliced) {
  const std::string bytes = "some bytes of a file, more than a few of them";
  const std::string message = message_of(1000, bytes);
  for (std::size_t slice_bytes = 1; slice_bytes <= message.size(); ++slice_bytes) {
    grpc::ByteBuffer sliced = in_slices(message, slice_bytes);
    const auto piece = read_piece(sliced);
    ASSERT_TRUE(piece) << slice_bytes;
    EXPECT_EQ(piece->offset, 1000U);
    EXPECT_EQ(piece->size, bytes.size());
    EXPECT_EQ(joined(*piece), bytes);
  }
}

TEST(UploadPiece, LeavesWhatWasCutOffToProtobuf) {
  const std::string message = message_of(1000, "some bytes");
  for (std::size_t size = 0; size < message.size(); ++size) {
    grpc::ByteBuffer cut = in_slices(message.substr(0, size), 3);
    EXPECT_FALSE(read_piece(cut)) << size;
  }
}

TEST(UploadPiece, ReadsNothingElseThanProtobufWould) {
  const std::string message = message_of(1000, "some bytes");
  for (std::size_t i = 0; i < message.size(); ++i) {
    for (int change = 1; change < 256; ++change) {
      std::string changed = message;
      changed[i] = static_cast<char>(changed[i] ^ change);
      grpc::ByteBuffer sliced = in_slices(changed, 5);
      const auto piece = read_piece(sliced);
      if (!piece) continue;
      v1::UploadGridRequest parsed;
      ASSERT_TRUE(parsed.ParseFromString(changed)) << i;
      EXPECT_EQ(joined(*piece), parsed.data().data());
      EXPECT_EQ(static_cast<std::int64_t>(piece->offset), parsed.data().offset());
    }
  }
}

TEST(UploadPiece, LeavesAStartToProtobuf) {
  v1::UploadGridRequest start;
  start.mutable_start()->set_size_bytes(5);
  grpc::ByteBuffer message = in_slices(start.SerializeAsString(), 64);
  EXPECT_FALSE(read_piece(message));
}

TEST(UploadPrefix, IsByteForByteWhatProtobufWrites) {
  for (const std::uint64_t offset :
       {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{1} << 40}) {
    for (const std::size_t size : {std::size_t{1}, std::size_t{127}, std::size_t{70000}}) {
      const std::string bytes(size, 'x');
      const FieldWriter prefix = upload_prefix(offset, size);
      std::string begin(prefix.size(), '\0');
      prefix.copy_before(reinterpret_cast<std::byte*>(begin.data() + begin.size()));
      EXPECT_TRUE(begin + bytes == message_of(offset, bytes)) << offset << ", " << size;
    }
  }
}

}  // namespace
}  // namespace tet::test
