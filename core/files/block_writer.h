// Rows of numbers to a file, in large blocks made on the fly.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include <absl/status/status.h>

#include "core/base/cancel.h"
#include "core/base/posix/atomic_file.h"

namespace tet {

/// How a long write is stopped and watched; both may be left out.
struct WriteControl {
  const Cancellation* cancellation = nullptr;
  std::function<void(double fraction)> progress;  ///< called on the writing thread, 0 .. 1
};

/// Writes the parts of a file one after the other. The first error sticks: later calls do
/// nothing, and `status` tells it at the end.
class BlockWriter {
 public:
  /// `total_bytes` is what `progress` measures against.
  BlockWriter(AtomicFile& file, std::uint64_t total_bytes, const WriteControl& control);

  void text(std::string_view text) { bytes(std::as_bytes(std::span(text))); }

  template <class Number>
  void number(Number value) {
    bytes(std::as_bytes(std::span(&value, 1)));
  }

  /// A column that is in memory as the file wants it.
  void bytes(std::span<const std::byte> column);

  /// `count` rows; row i is the trivially copyable value `make_row(i)`, without padding.
  template <class MakeRow>
  void rows(std::uint64_t count, const MakeRow& make_row);

  /// `count` lines of text: `write_line(i, place)` writes line i, of at most kMostLineBytes, at
  /// `place` and returns where it ends. How long text will be is known when it is there, so
  /// progress takes a line for `nominal_bytes`.
  template <class WriteLine>
  void lines(std::uint64_t count, std::uint64_t nominal_bytes, const WriteLine& write_line);

  static constexpr std::size_t kMostLineBytes = 512;

  /// The next bytes go to this offset of the file.
  void move_to(std::uint64_t offset);

  const absl::Status& status() const noexcept { return status_; }

 private:
  /// Large enough for the disk's full speed, small enough for the second-level cache.
  static constexpr std::size_t kBlockBytes = std::size_t{1} << 20;

  void write_block(std::span<const std::byte> block) { write_block(block, block.size()); }
  void write_block(std::span<const std::byte> block, std::uint64_t progress_bytes);

  AtomicFile& file_;
  std::uint64_t total_bytes_, written_bytes_ = 0;
  const WriteControl& control_;
  std::vector<std::byte> block_;
  absl::Status status_;
};

template <class MakeRow>
void BlockWriter::rows(std::uint64_t count, const MakeRow& make_row) {
  using Row = std::invoke_result_t<MakeRow, std::uint64_t>;
  static_assert(std::is_trivially_copyable_v<Row>);
  constexpr std::uint64_t kRowsPerBlock = kBlockBytes / sizeof(Row);
  for (std::uint64_t begin = 0; begin < count && status_.ok(); begin += kRowsPerBlock) {
    const std::uint64_t end = std::min(begin + kRowsPerBlock, count);
    std::byte* place = block_.data();
    for (std::uint64_t i = begin; i < end; ++i, place += sizeof(Row)) {
      const Row row = make_row(i);
      std::memcpy(place, &row, sizeof(Row));
    }
    write_block({block_.data(), place});
  }
}

template <class WriteLine>
void BlockWriter::lines(std::uint64_t count,
                        std::uint64_t nominal_bytes,
                        const WriteLine& write_line) {
  char* const begin = reinterpret_cast<char*>(block_.data());
  char* const full = begin + kBlockBytes - kMostLineBytes;
  for (std::uint64_t i = 0; i < count && status_.ok();) {
    const std::uint64_t first = i;
    char* place = begin;
    while (i < count && place < full) place = write_line(i++, place);
    write_block({block_.data(), static_cast<std::size_t>(place - begin)},
                (i - first) * nominal_bytes);
  }
}

}  // namespace tet
