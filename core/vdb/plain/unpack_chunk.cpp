#include "core/vdb/plain/unpack_chunk.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <absl/strings/str_format.h>
#include <blosc.h>
#include <zlib.h>

#include "core/vdb/walk/walk_refusal.h"

namespace tet {
namespace {

void copy_bytes(VdbCursor& cursor, std::span<std::byte> to) {
  while (!to.empty()) {
    const std::size_t count = std::min(to.size(), VdbCursor::kMostBytes);
    std::copy_n(cursor.take(count, "values"), count, to.data());
    to = to.subspan(count);
  }
}

void unpack_blosc(std::uint64_t at, const std::byte* packed, std::span<std::byte> bytes) {
  const int count = blosc_decompress_ctx(packed, bytes.data(), bytes.size(), /*threads=*/1);
  if (count < 0 || static_cast<std::size_t>(count) != bytes.size()) {
    refuse_at(
        at, absl::StrFormat("blosc unpacks %d bytes, and %d belong here", count, bytes.size()));
  }
}

void unpack_zlib(std::uint64_t at,
                 std::span<const std::byte> packed,
                 std::span<std::byte> bytes) {
  uLongf count = bytes.size();
  const int error = ::uncompress(reinterpret_cast<Bytef*>(bytes.data()), &count,
                                 reinterpret_cast<const Bytef*>(packed.data()), packed.size());
  if (error != Z_OK) refuse_at(at, absl::StrFormat("zlib cannot unpack it (%d)", error));
  if (count != bytes.size()) {
    refuse_at(
        at, absl::StrFormat("zlib unpacks %d bytes, and %d belong here", count, bytes.size()));
  }
}

}  // namespace

const std::byte* RunUnpacker::packed_bytes(VdbCursor& cursor, std::size_t count) {
  if (count <= VdbCursor::kMostBytes) return cursor.take(count, "packed values");
  packed_.resize(count);
  copy_bytes(cursor, packed_);
  return packed_.data();
}

void RunUnpacker::read(VdbCursor& cursor, std::span<std::byte> bytes) {
  if (!compression_.blosc && !compression_.zip) return copy_bytes(cursor, bytes);
  const std::uint64_t at = cursor.position();
  const auto length = cursor.read<std::int64_t>("chunk length");
  if (length <= 0) return copy_bytes(cursor, bytes);
  // Both write at most the bytes there are; the walk has bound what they read.
  const auto count = static_cast<std::size_t>(length);
  if (count > cursor.left()) refuse_at(at, "a chunk ends beyond the file");
  const std::byte* const packed = packed_bytes(cursor, count);
  if (compression_.blosc) {
    unpack_blosc(at, packed, bytes);
  } else {
    unpack_zlib(at, {packed, count}, bytes);
  }
}

float half_to_float(std::uint16_t half) noexcept {
  constexpr std::uint32_t kFractionBits = 10, kMoreBits = 23 - kFractionBits;
  constexpr std::uint32_t kMoreBias = 127 - 15;
  const std::uint32_t sign = static_cast<std::uint32_t>(half & 0x8000U) << 16;
  const std::uint32_t rest = half & 0x7fffU;
  const std::uint32_t exponent = rest >> kFractionBits;
  if (exponent == 0) {  // a multiple of 2^-24, which every float can be
    const float value = std::ldexp(static_cast<float>(rest), -24);
    return std::bit_cast<float>(std::bit_cast<std::uint32_t>(value) | sign);
  }
  const std::uint32_t bias = exponent == 31 ? 2 * kMoreBias : kMoreBias;
  return std::bit_cast<float>(sign | ((rest << kMoreBits) + (bias << 23)));
}

}  // namespace tet
