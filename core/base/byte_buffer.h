// Memory for whole columns of a mesh.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

namespace tet {

/// Memory that is not zeroed when allocated: its first writer touches it, on its own core.
///
/// A large one asks for huge pages, whose first touch costs a fraction of what small pages
/// cost.
class ByteBuffer {
 public:
  ByteBuffer() = default;
  explicit ByteBuffer(std::size_t size);

  std::span<std::byte> bytes() noexcept { return {bytes_.get(), size_}; }
  std::span<const std::byte> bytes() const noexcept { return {bytes_.get(), size_}; }
  std::size_t size() const noexcept { return size_; }

 private:
  struct Free {
    void operator()(std::byte* bytes) const noexcept;
  };
  std::unique_ptr<std::byte[], Free> bytes_;
  std::size_t size_ = 0;
};

}  // namespace tet
