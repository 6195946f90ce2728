// Numbers to bytes and back: little-endian as they lie, or varints as protobuf has them.
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace tet {

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie");

/// Appends to bytes that somebody else holds.
class ByteWriter {
 public:
  explicit ByteWriter(std::vector<std::byte>& bytes) : bytes_(bytes) {}

  /// Room for `size` bytes, which are zeros until they are written; until the next is appended.
  std::byte* extend(std::size_t size) {
    bytes_.resize(bytes_.size() + size);
    return bytes_.data() + bytes_.size() - size;
  }
  void append(std::span<const std::byte> bytes) {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  template <std::integral Number>
  void number(Number value) {
    std::memcpy(extend(sizeof(value)), &value, sizeof(value));
  }
  void varint(std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) number(static_cast<std::uint8_t>(value | 0x80));
    number(static_cast<std::uint8_t>(value));
  }

 private:
  std::vector<std::byte>& bytes_;
};

/// Reads as long as there are bytes; afterwards zeros and nothing, and `failed`.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : rest_(bytes) {}

  bool failed() const { return failed_; }
  bool at_end() const { return rest_.empty(); }

  std::span<const std::byte> take(std::size_t size) {
    if (size > rest_.size()) {
      failed_ = true;
      return {};
    }
    const auto taken = rest_.first(size);
    rest_ = rest_.subspan(size);
    return taken;
  }
  template <std::integral Number>
  Number number() {
    Number value = 0;
    if (const auto bytes = take(sizeof(value)); !bytes.empty()) {
      std::memcpy(&value, bytes.data(), sizeof(value));
    }
    return value;
  }
  std::uint64_t varint() {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 63; shift += 7) {
      const auto byte = number<std::uint8_t>();
      value |= std::uint64_t{byte & 0x7fU} << shift;
      if ((byte & 0x80) == 0) return value;
    }
    failed_ = true;
    return 0;
  }

 protected:
  void fail() { failed_ = true; }

 private:
  std::span<const std::byte> rest_;
  bool failed_ = false;
};

}  // namespace tet
