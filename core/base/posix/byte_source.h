// Bytes in memory or in a file, read window by window.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tet {

/// Bytes that may be read at any offset. Does not own them; cheap to copy.
///
/// Files are read, never mapped: one that is cut while it is read gives short reads, and no
/// SIGBUS.
class ByteSource {
 public:
  explicit ByteSource(std::span<const std::byte> bytes) : bytes_(bytes), size_(bytes.size()) {}
  /// `descriptor` stays open as long as the source is used; `size` is the file's.
  ByteSource(int descriptor, std::uint64_t size) : descriptor_(descriptor), size_(size) {}

  std::uint64_t size() const noexcept { return size_; }

  /// Returns as many bytes from `offset` on as are at hand: all of them when they are in
  /// memory, and of a file at most `window_bytes`, which are read into `buffer`. Empty at the
  /// end, and when reading fails.
  std::span<const std::byte> window(std::uint64_t offset,
                                    std::size_t window_bytes,
                                    std::vector<std::byte>& buffer) const;

 private:
  std::span<const std::byte> read_file(std::uint64_t offset, std::span<std::byte> into) const;

  std::span<const std::byte> bytes_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace tet
