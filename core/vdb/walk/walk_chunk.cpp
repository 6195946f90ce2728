#include "core/vdb/walk/walk_chunk.h"

#include <array>
#include <cstddef>
#include <string>

#include <absl/strings/str_format.h>

#include "core/vdb/walk/walk_refusal.h"

namespace tet {
namespace {

/// The most that one byte can stand for: deflate's runs of 258 bytes in two bits, LZ4's in
/// lengths of 255.
constexpr std::uint64_t kDeflateRatio = 1032;
constexpr std::uint64_t kLz4Ratio = 255;

/// zlib's header and checksum, and the shortest block.
constexpr std::uint64_t kShortestZlib = 8;

/// Blosc 1.21: what its header says, byte by byte.
struct BloscHeader {
  static constexpr std::uint64_t kBytes = 16;
  std::uint8_t format, codec_format, flags, value_bytes;
  std::int32_t bytes, block_bytes, length;

  bool is_copy() const noexcept { return (flags & 0x02) != 0; }
  bool is_from_the_future() const noexcept { return (flags & 0x08) != 0; }
  bool is_split() const noexcept { return (flags & 0x10) == 0; }
  int codec() const noexcept { return flags >> 5; }
};

constexpr int kLz4 = 1;  // OpenVDB has always asked for this codec
constexpr std::uint8_t kBloscFormat = 2;
constexpr std::uint8_t kLz4Format = 1;
constexpr std::int32_t kMostSplits = 16;
constexpr std::int32_t kSmallestSplit = 128;

BloscHeader read_blosc_header(VdbCursor& cursor) {
  BloscHeader header{};
  header.format = cursor.read<std::uint8_t>("blosc format");
  header.codec_format = cursor.read<std::uint8_t>("blosc codec format");
  header.flags = cursor.read<std::uint8_t>("blosc flags");
  header.value_bytes = cursor.read<std::uint8_t>("blosc value size");
  header.bytes = cursor.read<std::int32_t>("blosc size");
  header.block_bytes = cursor.read<std::int32_t>("blosc block size");
  header.length = cursor.read<std::int32_t>("blosc length");
  return header;
}

void check_blosc_header(const BloscHeader& header,
                        std::uint64_t at,
                        std::uint64_t length,
                        std::uint64_t bytes) {
  if (header.format != kBloscFormat || header.is_from_the_future() || header.value_bytes == 0) {
    refuse_at(at,
              absl::StrFormat("blosc format %d with flags %#x and values of %d bytes is not "
                              "known",
                              header.format, header.flags, header.value_bytes));
  }
  if (header.bytes < 0 || static_cast<std::uint64_t>(header.bytes) != bytes) {
    refuse_at(at, absl::StrFormat("a blosc buffer says that it holds %d bytes, and %d belong "
                                  "here",
                                  header.bytes, bytes));
  }
  if (header.length < 0 || static_cast<std::uint64_t>(header.length) != length) {
    refuse_at(at, absl::StrFormat("a blosc buffer says that it is %d bytes long, and has %d",
                                  header.length, length));
  }
  if (bytes > 0 && (header.block_bytes <= 0 || header.block_bytes > header.bytes)) {
    refuse_at(at, absl::StrFormat("blosc blocks of %d bytes do not fit %d bytes",
                                  header.block_bytes, bytes));
  }
}

/// One stream of a block: `bytes` bytes, compressed or not. `end` is where the buffer ends.
void walk_split(VdbCursor& cursor, std::int64_t bytes, std::uint64_t end) {
  const std::uint64_t at = cursor.position();
  if (end - at < sizeof(std::int32_t)) refuse_at(at, "a blosc buffer ends within its blocks");
  const std::int64_t length = cursor.read<std::int32_t>("blosc stream length");
  if (length <= 0 || length > bytes ||
      static_cast<std::uint64_t>(length) > end - cursor.position() ||
      static_cast<std::uint64_t>(length) * kLz4Ratio < static_cast<std::uint64_t>(bytes)) {
    refuse_at(at,
              absl::StrFormat("a blosc stream of %d bytes claims to be %d long, with %d left",
                              bytes, length, end - cursor.position()));
  }
  cursor.skip(static_cast<std::uint64_t>(length), "blosc stream");
}

/// The number of streams that blosc divides a block into: one for each byte of a value.
std::int32_t count_splits(const BloscHeader& header, std::int32_t block_bytes) {
  const bool split = header.is_split() && header.value_bytes <= kMostSplits &&
                     block_bytes / header.value_bytes >= kSmallestSplit &&
                     block_bytes == header.block_bytes;
  return split ? header.value_bytes : 1;
}

void walk_block(VdbCursor& cursor,
                const BloscHeader& header,
                std::int32_t block_bytes,
                std::uint64_t end) {
  const std::int32_t splits = count_splits(header, block_bytes);
  if (block_bytes % splits != 0) {
    refuse_at(cursor.position(),
              absl::StrFormat("blosc cannot have split %d bytes by %d", block_bytes, splits));
  }
  for (std::int32_t i = 0; i < splits; ++i) walk_split(cursor, block_bytes / splits, end);
}

/// The blocks of a buffer, which must lie one behind the other as a single thread writes them.
/// `start` and `end` are those of the buffer.
void walk_blocks(VdbCursor& cursor,
                 const BloscHeader& header,
                 std::uint64_t start,
                 std::uint64_t end) {
  const auto blocks = static_cast<std::uint64_t>((header.bytes - 1) / header.block_bytes + 1);
  if (blocks > (end - cursor.position()) / sizeof(std::int32_t)) {
    refuse_at(start,
              absl::StrFormat("%d blosc blocks do not fit %d bytes", blocks, end - start));
  }
  std::vector<std::uint32_t> starts;  // grows as the file's bytes are read
  for (std::uint64_t i = 0; i < blocks; ++i) {
    starts.push_back(cursor.read<std::uint32_t>("blosc block start"));
  }
  std::int32_t left = header.bytes;
  for (const std::uint32_t block_start : starts) {
    if (start + block_start != cursor.position()) {
      refuse_at(start, absl::StrFormat("a blosc block begins at its byte %d and not at %d",
                                       cursor.position() - start, block_start));
    }
    const std::int32_t block_bytes = std::min(left, header.block_bytes);
    walk_block(cursor, header, block_bytes, end);
    left -= block_bytes;
  }
}

void walk_zlib(VdbCursor& cursor, std::uint64_t length, std::uint64_t bytes) {
  const std::uint64_t at = cursor.position();
  if (length < kShortestZlib || length >= bytes || length * kDeflateRatio < bytes) {
    refuse_at(at, absl::StrFormat("zlib cannot have made %d bytes of %d", length, bytes));
  }
  const auto method = cursor.read<std::uint8_t>("zlib method");
  const auto flags = cursor.read<std::uint8_t>("zlib flags");
  const bool deflate = (method & 0x0f) == 8 && (method >> 4) <= 7 && (flags & 0x20) == 0;
  if (!deflate || (method * 256 + flags) % 31 != 0) {
    refuse_at(at, absl::StrFormat("%02x%02x begins no zlib stream", method, flags));
  }
  cursor.skip(length - 2, "zlib stream");
}

}  // namespace

void walk_blosc(VdbCursor& cursor, std::uint64_t length, std::uint64_t bytes) {
  const std::uint64_t start = cursor.position();
  const std::uint64_t end = start + length;
  if (length < BloscHeader::kBytes || length > bytes + BloscHeader::kBytes) {
    refuse_at(start, absl::StrFormat("blosc cannot have made %d bytes of %d", length, bytes));
  }
  const BloscHeader header = read_blosc_header(cursor);
  check_blosc_header(header, start, length, bytes);
  if (header.is_copy()) {
    if (length != bytes + BloscHeader::kBytes) {
      refuse_at(start, absl::StrFormat("a blosc copy of %d bytes is %d long", bytes, length));
    }
    cursor.skip(bytes, "blosc copy");
  } else if (bytes > 0) {
    if (header.codec() != kLz4 || header.codec_format != kLz4Format) {
      refuse_at(start, absl::StrFormat("blosc codec %d in format %d is not LZ4", header.codec(),
                                       header.codec_format));
    }
    walk_blocks(cursor, header, start, end);
  }
  if (cursor.position() != end) {
    refuse_at(cursor.position(),
              absl::StrFormat("a blosc buffer has %d bytes too many", end - cursor.position()));
  }
}

void walk_chunk(VdbCursor& cursor, std::uint64_t bytes, const VdbCompression& compression) {
  if (!compression.blosc && !compression.zip) return cursor.skip(bytes, "values");
  const std::uint64_t at = cursor.position();
  const auto length = cursor.read<std::int64_t>("chunk length");
  if (length <= 0) {  // stored as it was, since it would have grown
    if (length != -static_cast<std::int64_t>(bytes)) {
      refuse_at(at, absl::StrFormat("a chunk of %d bytes has the length %d", bytes, length));
    }
    return cursor.skip(bytes, "chunk");
  }
  const auto compressed = static_cast<std::uint64_t>(length);
  if (compressed > cursor.left()) {
    refuse_at(
        at, absl::StrFormat("a chunk claims %d bytes and %d are left", length, cursor.left()));
  }
  compression.blosc ? walk_blosc(cursor, compressed, bytes)
                    : walk_zlib(cursor, compressed, bytes);
}

}  // namespace tet
