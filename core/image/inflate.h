// Streams of zlib and gzip, unpacked piece by piece.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/posix/byte_source.h"

struct z_stream_s;

namespace tet {

/// Unpacks one stream that begins somewhere in a file; of gzip all members that follow each
/// other, as bgzip writes them. Throws ImageRefusal where it is broken.
class Inflater {
 public:
  Inflater(const ByteSource& source, std::uint64_t offset, std::uint64_t bytes);
  ~Inflater();
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  /// Fills `into`; less only at the stream's end. Returns how much there was.
  std::size_t read(std::span<std::byte> into);

  /// What the member that was read last has unpacked to so far.
  std::uint64_t member_bytes() const noexcept;

 private:
  bool refill();
  bool begin_next_member();

  ByteSource source_;
  std::uint64_t at_, end_;
  std::vector<std::byte> window_;
  std::unique_ptr<z_stream_s> stream_;
  bool has_begun_ = false, is_gzip_ = false, done_ = false;
};

/// Unpacks a whole stream that is as long as `into`. Throws ImageRefusal.
void inflate_block(std::span<const std::byte> packed, std::span<std::byte> into);

}  // namespace tet
