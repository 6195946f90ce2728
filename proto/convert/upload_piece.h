// A piece of an upload, in the memory it came in.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/slice.h>

namespace tet {

/// Bytes of a file from `offset` on: `bytes` one after another, within `slices`.
struct UploadPiece {
  std::uint64_t offset = 0, size = 0;
  std::vector<std::string_view> bytes;
  std::vector<grpc::Slice> slices;
};

/// Reads an UploadGridRequest of `data` as clients write it: no field twice or unknown, the
/// bytes last. Anything else, malformed bytes too, is left to protobuf: nothing. `message` is
/// read, not changed.
std::optional<UploadPiece> read_piece(grpc::ByteBuffer& message);

}  // namespace tet
