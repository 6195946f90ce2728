#include "core/base/byte_buffer.h"

#include <cstdlib>
#include <new>
#include <sys/mman.h>
#include <utility>

namespace tet {
namespace {

constexpr std::size_t kHugePage = std::size_t{2} << 20;
constexpr std::size_t kCacheLine = 64;

constexpr std::size_t rounded_up(std::size_t size, std::size_t unit) {
  return (size + unit - 1) / unit * unit;
}

}  // namespace

ByteBuffer::ByteBuffer(std::size_t size) : size_(size), capacity_(size) {
  // A smaller one would leave most of its last huge page unused.
  const bool huge = size >= 2 * kHugePage;
  const std::size_t unit = huge ? kHugePage : kCacheLine;
  void* const memory = std::aligned_alloc(unit, rounded_up(size + (size == 0), unit));
  if (memory == nullptr) throw std::bad_alloc();
  // Advice alone: where the system has no huge pages, small ones do.
  if (huge) ::madvise(memory, size, MADV_HUGEPAGE);
  bytes_.reset(static_cast<std::byte*>(memory));
}

ByteBuffer::ByteBuffer(std::size_t size, ByteBuffer&& used) {
  if (used.capacity_.value < size) {
    // What has grown once will grow again; pages that are never touched cost nothing.
    const std::size_t spare = used.capacity_.value == 0 ? 0 : size / 16;
    used = {};  // before there is another one
    *this = ByteBuffer(size + spare);
    size_ = size;
  } else {
    *this = std::move(used);
    size_ = size;
  }
}

void ByteBuffer::Free::operator()(std::byte* bytes) const noexcept { std::free(bytes); }

}  // namespace tet
