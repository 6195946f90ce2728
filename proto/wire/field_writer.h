// The first bytes of a protobuf message whose last field is written where it lies.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace tet {

/// How protobuf writes a field; the numbers are its own.
enum class FieldCoding : std::uint32_t { kVarint = 0, kBytes = 2, kFixed32 = 5 };

/// What stands before a field.
constexpr std::uint32_t tag_of(std::uint32_t field, FieldCoding coding) noexcept {
  return field << 3 | static_cast<std::uint32_t>(coding);
}

/// Writes fields one after another as protobuf does, leaving out those that are 0 or empty.
class FieldWriter {
 public:
  /// It holds this much: a tag of one byte and a varint of ten for each of ten fields.
  static constexpr std::size_t kCapacity = 128;

  void number(std::uint32_t field, std::uint64_t value) noexcept {
    if (value == 0) return;
    varint(tag_of(field, FieldCoding::kVarint));
    varint(value);
  }
  void fixed32(std::uint32_t field, std::uint32_t value) noexcept {
    if (value == 0) return;
    varint(tag_of(field, FieldCoding::kFixed32));
    for (int shift = 0; shift < 32; shift += 8) put(static_cast<std::uint8_t>(value >> shift));
  }
  /// Announces `size` bytes that follow.
  void bytes(std::uint32_t field, std::uint64_t size) noexcept {
    if (size > 0) message(field, size);
  }
  /// Announces a message of `size` bytes, which may be empty.
  void message(std::uint32_t field, std::uint64_t size) noexcept {
    varint(tag_of(field, FieldCoding::kBytes));
    varint(size);
  }
  void append(const FieldWriter& other) noexcept {
    std::memcpy(bytes_.data() + size_, other.bytes_.data(), other.size_);
    size_ += other.size_;
  }

  std::size_t size() const noexcept { return size_; }
  /// Copies what was written to the `size()` bytes before `end`.
  void copy_before(std::byte* end) const noexcept {
    std::memcpy(end - size_, bytes_.data(), size_);
  }

 private:
  void varint(std::uint64_t value) noexcept {
    for (; value >= 0x80; value >>= 7) put(static_cast<std::uint8_t>(value | 0x80));
    put(static_cast<std::uint8_t>(value));
  }
  void put(std::uint8_t byte) noexcept { bytes_[size_++] = std::byte{byte}; }

  std::array<std::byte, kCapacity> bytes_;
  std::size_t size_ = 0;
};

}  // namespace tet
