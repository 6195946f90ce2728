// Where a chunk's columns lie in shared memory.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "proto/wire/chunk_frame.h"

namespace tet {

/// Columns one after another in the order in which they are sent, each at the next multiple of
/// ChunkFrame::kAlignment.
class SharedColumns {
 public:
  explicit constexpr SharedColumns(
      const std::array<std::size_t, ChunkFrame::kColumns>& column_bytes) noexcept
      : bytes_(column_bytes) {
    for (std::size_t i = 0; i < bytes_.size(); ++i) {
      begin_[i] =
          (end_ + ChunkFrame::kAlignment - 1) / ChunkFrame::kAlignment * ChunkFrame::kAlignment;
      end_ = begin_[i] + bytes_[i];
    }
  }

  /// Size of the memory that holds them all.
  constexpr std::size_t bytes() const noexcept { return end_; }

  /// Column i; `block` is where the first begins.
  template <class Byte>
  std::span<Byte> column(Byte* block, std::size_t i) const noexcept {
    return {block + begin_[i], bytes_[i]};
  }

 private:
  std::array<std::size_t, ChunkFrame::kColumns> bytes_;
  std::array<std::size_t, ChunkFrame::kColumns> begin_{};
  std::size_t end_ = 0;
};

}  // namespace tet
