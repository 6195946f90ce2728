#include "client/library/chunk_message.h"

#include <algorithm>
#include <cstring>

#include <google/protobuf/io/coded_stream.h>
#include <grpcpp/support/proto_buffer_reader.h>

#include "proto/wire/checksum.h"
#include "proto/wire/field_writer.h"

namespace tet {

namespace {

using google::protobuf::io::CodedInputStream;

// What is copied is read twice, the second time from the nearest cache.
constexpr std::size_t kPieceBytes = std::size_t{16} << 10;

constexpr std::uint32_t varint_tag(std::uint32_t field) {
  return tag_of(field, FieldCoding::kVarint);
}

constexpr std::uint32_t bytes_tag(std::uint32_t field) {
  return tag_of(field, FieldCoding::kBytes);
}

/// Reads the fields of a MeshChunk in increasing order, which is the one they are written in.
class ChunkReader {
 public:
  explicit ChunkReader(CodedInputStream& input) : input_(input) {}

  /// False at anything that is not such a field, and where the input ends within one.
  bool read() {
    for (std::uint32_t last = 0, tag; (tag = input_.ReadTag()) != 0; last = tag) {
      if (tag <= last || !read_field(tag)) return false;
    }
    return input_.ConsumedEntireMessage();
  }

  const ReceivedChunk& chunk() const { return chunk_; }

 private:
  bool read_field(std::uint32_t tag) {
    ChunkNumbers& numbers = chunk_.numbers;
    switch (tag) {
      case varint_tag(chunk_field::kIndex):
        return read_number(numbers.index);
      case varint_tag(chunk_field::kFirstVertex):
        return read_number(numbers.first_vertex);
      case varint_tag(chunk_field::kVertexCount):
        return read_number(numbers.vertex_count);
      case varint_tag(chunk_field::kFirstTet):
        return read_number(numbers.first_tet);
      case varint_tag(chunk_field::kTetCount):
        return read_number(numbers.tet_count);
      case tag_of(chunk_field::kChecksum, FieldCoding::kFixed32):
        return input_.ReadLittleEndian32(&numbers.checksum);
      case bytes_tag(chunk_field::kPositions):
        return read_column(chunk_.columns[0]);
      case bytes_tag(chunk_field::kTets):
        return read_column(chunk_.columns[1]);
      case bytes_tag(chunk_field::kRegions):
        return read_column(chunk_.columns[2]);
      case bytes_tag(chunk_field::kFields):
        return read_column(chunk_.columns[3]);
      case varint_tag(chunk_field::kFirstFace):
        return read_number(numbers.first_face);
      case varint_tag(chunk_field::kFaceCount):
        return read_number(numbers.face_count);
      case bytes_tag(chunk_field::kFaces):
        return read_column(chunk_.columns[4]);
      case bytes_tag(chunk_field::kFaceTets):
        return read_column(chunk_.columns[5]);
      case bytes_tag(chunk_field::kFaceLabels):
        return read_column(chunk_.columns[6]);
      default:
        return false;
    }
  }

  // Negative counts arrive as huge ones, which whoever uses them refuses.
  bool read_number(std::uint64_t& number) { return input_.ReadVarint64(&number); }

  bool read_column(ReceivedChunk::Column& column) {
    int size = 0;
    if (!input_.ReadVarintSizeAsInt(&size)) return false;
    column = {static_cast<std::size_t>(input_.CurrentPosition()),
              static_cast<std::size_t>(size)};
    return input_.Skip(size);
  }

  CodedInputStream& input_;
  ReceivedChunk chunk_;
};

/// Goes through a message's bytes from its beginning, slice by slice.
class MessageBytes {
 public:
  explicit MessageBytes(grpc::ByteBuffer& message) : reader_(&message) {}

  /// Up to `most` bytes from where it stands, at least one unless the message ends.
  std::span<const std::byte> next(std::size_t most) {
    if (slice_.empty()) read_slice();
    const auto piece = slice_.first(std::min(most, slice_.size()));
    slice_ = slice_.subspan(piece.size());
    position_ += piece.size();
    return piece;
  }

  void go_to(std::size_t position) {
    while (position_ < position && !next(position - position_).empty()) {
    }
  }

 private:
  void read_slice() {
    const void* data = nullptr;
    int size = 0;
    // A slice may be empty; the end is where there is none.
    while (slice_.empty() && reader_.Next(&data, &size)) {
      slice_ = {static_cast<const std::byte*>(data), static_cast<std::size_t>(size)};
    }
  }

  grpc::ProtoBufferReader reader_;
  std::span<const std::byte> slice_;
  std::size_t position_ = 0;
};

/// Calls `use(i, piece)` for the bytes of each column i, one piece after another.
template <class Use>
void read_columns(grpc::ByteBuffer& message, const ReceivedChunk& chunk, const Use& use) {
  MessageBytes bytes(message);
  for (std::size_t i = 0; i < chunk.columns.size(); ++i) {
    bytes.go_to(chunk.columns[i].begin);
    for (std::size_t left = chunk.columns[i].size; left > 0;) {
      const auto piece = bytes.next(std::min(left, kPieceBytes));
      if (piece.empty()) break;
      use(i, piece);
      left -= piece.size();
    }
  }
}

}  // namespace

std::array<std::size_t, kMeshColumns> sizes_of(const ReceivedChunk& chunk) {
  std::array<std::size_t, kMeshColumns> sizes{};
  std::ranges::transform(chunk.columns, sizes.begin(), &ReceivedChunk::Column::size);
  return sizes;
}

std::array<std::size_t, kMeshColumns> sizes_of(
    const std::array<std::string_view, kMeshColumns>& columns) {
  std::array<std::size_t, kMeshColumns> sizes{};
  std::ranges::transform(columns, sizes.begin(), &std::string_view::size);
  return sizes;
}

void copy_columns(const std::array<std::string_view, kMeshColumns>& from,
                  const ChunkColumns& to) {
  const auto places = to.all();
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!places[i].empty()) std::memcpy(places[i].data(), from[i].data(), places[i].size());
  }
}

std::optional<ReceivedChunk> read_chunk(grpc::ByteBuffer& message) {
  if (!message.Valid()) return std::nullopt;
  grpc::ProtoBufferReader bytes(&message);
  CodedInputStream input(&bytes);
  int size = 0;
  if (input.ReadTag() != bytes_tag(chunk_field::kEvent)) return std::nullopt;
  if (!input.ReadVarintSizeAsInt(&size)) return std::nullopt;
  const auto begin = static_cast<std::size_t>(input.CurrentPosition());
  if (begin + static_cast<std::size_t>(size) != message.Length()) return std::nullopt;
  ChunkReader reader(input);
  if (!reader.read()) return std::nullopt;
  return reader.chunk();
}

std::uint32_t copy_columns(grpc::ByteBuffer& message,
                           const ReceivedChunk& chunk,
                           const ChunkColumns& to) {
  std::uint32_t checksum = 0;
  std::array left = to.all();
  read_columns(message, chunk, [&](std::size_t i, std::span<const std::byte> piece) {
    checksum = add_to_checksum(checksum, piece);
    std::memcpy(left[i].data(), piece.data(), piece.size());
    left[i] = left[i].subspan(piece.size());
  });
  return checksum;
}

std::uint32_t columns_checksum(grpc::ByteBuffer& message, const ReceivedChunk& chunk) {
  std::uint32_t checksum = 0;
  read_columns(message, chunk, [&](std::size_t, std::span<const std::byte> piece) {
    checksum = add_to_checksum(checksum, piece);
  });
  return checksum;
}

}  // namespace tet
