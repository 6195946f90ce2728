// Memory for whole columns of a mesh.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <utility>

namespace tet {

/// Memory that is not zeroed when allocated: its first writer touches it, on its own core.
///
/// A large one asks for huge pages, whose first touch costs a fraction of what small pages
/// cost.
class ByteBuffer {
 public:
  ByteBuffer() = default;
  explicit ByteBuffer(std::size_t size);
  /// Takes over the memory of `used` where it is large enough: its pages are touched already,
  /// which for a large one costs as much as filling it.
  ByteBuffer(std::size_t size, ByteBuffer&& used);

  std::span<std::byte> bytes() noexcept { return {bytes_.get(), size_.value}; }
  std::span<const std::byte> bytes() const noexcept { return {bytes_.get(), size_.value}; }
  std::size_t size() const noexcept { return size_.value; }
  /// The most bytes that another one may have in this one's memory.
  std::size_t capacity() const noexcept { return capacity_.value; }

 private:
  struct Free {
    void operator()(std::byte* bytes) const noexcept;
  };
  /// A number that is 0 again when it was moved from.
  struct Size {
    std::size_t value = 0;
    Size() = default;
    Size(std::size_t size) noexcept : value(size) {}
    Size(Size&& from) noexcept : value(std::exchange(from.value, 0)) {}
    Size& operator=(Size&& from) noexcept {
      value = std::exchange(from.value, 0);
      return *this;
    }
  };
  std::unique_ptr<std::byte[], Free> bytes_;
  Size size_, capacity_;
};

}  // namespace tet
