#include "proto/convert/upload_piece.h"

#include <algorithm>
#include <cstddef>

#include <google/protobuf/io/coded_stream.h>
#include <grpcpp/support/proto_buffer_reader.h>

#include "proto/wire/upload_frame.h"

namespace tet {

namespace {

using google::protobuf::io::CodedInputStream;

constexpr std::uint32_t kDataTag = tag_of(upload_field::kData, FieldCoding::kBytes);
constexpr std::uint32_t kOffsetTag = tag_of(upload_field::kOffset, FieldCoding::kVarint);
constexpr std::uint32_t kBytesTag = tag_of(upload_field::kBytes, FieldCoding::kBytes);

/// A run of bytes that ends with the message.
struct Tail {
  std::uint64_t offset = 0;  ///< in the file
  std::size_t begin = 0;     ///< in the message
};

/// Reads the size of what must be the rest of the message.
bool reads_rest(CodedInputStream& input, std::size_t message_bytes) {
  int size = 0;
  if (!input.ReadVarintSizeAsInt(&size)) return false;
  return static_cast<std::size_t>(input.CurrentPosition()) + static_cast<std::size_t>(size) ==
         message_bytes;
}

std::optional<Tail> find_tail(grpc::ByteBuffer& message) {
  grpc::ProtoBufferReader bytes(&message);
  CodedInputStream input(&bytes);
  Tail tail;
  if (input.ReadTag() != kDataTag || !reads_rest(input, message.Length())) return std::nullopt;
  std::uint32_t tag = input.ReadTag();
  if (tag == kOffsetTag) {
    if (!input.ReadVarint64(&tail.offset)) return std::nullopt;
    tag = input.ReadTag();
  }
  if (tag != kBytesTag || !reads_rest(input, message.Length())) return std::nullopt;
  tail.begin = static_cast<std::size_t>(input.CurrentPosition());
  return tail;
}

}  // namespace

std::optional<UploadPiece> read_piece(grpc::ByteBuffer& message) {
  if (!message.Valid()) return std::nullopt;
  const std::optional<Tail> tail = find_tail(message);
  if (!tail) return std::nullopt;
  UploadPiece piece;
  piece.offset = tail->offset;
  piece.size = message.Length() - tail->begin;
  if (!message.Dump(&piece.slices).ok()) return std::nullopt;
  std::size_t before = tail->begin;
  for (const grpc::Slice& slice : piece.slices) {
    std::string_view bytes(reinterpret_cast<const char*>(slice.begin()), slice.size());
    bytes.remove_prefix(std::min(before, bytes.size()));
    before -= std::min(before, slice.size());
    if (!bytes.empty()) piece.bytes.push_back(bytes);
  }
  return piece;
}

}  // namespace tet
