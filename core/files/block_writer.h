// Rows of numbers to a file, in large blocks made on the fly.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include <absl/status/status.h>

#include "core/base/cancel.h"
#include "core/base/parallel.h"
#include "core/base/posix/atomic_file.h"
#include "core/base/scratch_pool.h"

namespace tet {

/// How a long write is stopped and watched; both may be left out.
struct WriteControl {
  const Cancellation* cancellation = nullptr;
  std::function<void(double fraction)> progress;  ///< called on the writing thread, 0 .. 1

  /// The cancellation, or one that nobody requests: for what is found out before the first
  /// block, which is written only if it was not requested until then.
  const Cancellation& stop() const noexcept {
    static const Cancellation never;
    return cancellation != nullptr ? *cancellation : never;
  }
};

/// Writes the parts of a file one after the other. The first error sticks: later calls do
/// nothing, and `status` tells it at the end.
class BlockWriter {
 public:
  /// `total_bytes` is what `progress` measures against.
  BlockWriter(AtomicFile& file, std::uint64_t total_bytes, const WriteControl& control);

  /// Makes a writer of the same file for another thread: it begins where this one is, has a
  /// status of its own, and tells no progress. Thread-safe while nobody writes with this one.
  BlockWriter another() const { return {*this, Another()}; }

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

  /// Writes what `rows` does, where rows may be made in any order and on any thread of the
  /// caller's pool.
  template <class MakeRow>
  void rows_side_by_side(std::uint64_t count, const MakeRow& make_row);

  /// `count` lines of text: `write_line(i, place)` writes line i, of at most kMostLineBytes, at
  /// `place` and returns where it ends. How long text will be is known when it is there, so
  /// progress takes a line for `nominal_bytes`.
  template <class WriteLine>
  void lines(std::uint64_t count, std::uint64_t nominal_bytes, const WriteLine& write_line);

  static constexpr std::size_t kMostLineBytes = 512;

  /// The next bytes go to this offset of the file.
  void move_to(std::uint64_t offset) noexcept { position_ = offset; }
  std::uint64_t position() const noexcept { return position_; }

  const absl::Status& status() const noexcept { return status_; }

  /// False, with the status, where a write failed or is cancelled.
  bool goes_on() { return status_.ok() && !is_cancelled(); }

 private:
  /// Large enough for the disk's full speed, small enough for the second-level cache.
  static constexpr std::size_t kBlockBytes = std::size_t{1} << 20;
  /// Made side by side before progress is told and a failure ends it.
  static constexpr std::uint64_t kBlocksAtOnce = 16;
  using Block = std::array<std::byte, kBlockBytes>;
  using Turn = ScratchPool<Block>::Turn;

  struct Another {};
  BlockWriter(const BlockWriter& writer, Another);

  void write_block(std::span<const std::byte> block) { write_block(block, block.size()); }
  void write_block(std::span<const std::byte> block, std::uint64_t progress_bytes);
  bool is_cancelled();
  void tell_progress(std::uint64_t bytes);

  /// Makes the rows from `begin` to `end`, which fit in a block, and returns their bytes.
  template <class MakeRow>
  static std::span<const std::byte> make_rows(std::uint64_t begin,
                                              std::uint64_t end,
                                              const MakeRow& make_row,
                                              Block& block);

  AtomicFile& file_;
  std::uint64_t position_ = 0;
  std::uint64_t total_bytes_, written_bytes_ = 0;
  const WriteControl& control_;
  bool tells_progress_ = true;
  std::shared_ptr<ScratchPool<Block>> blocks_;  ///< of all writers of the file
  absl::Status status_;
};

template <class MakeRow>
std::span<const std::byte> BlockWriter::make_rows(std::uint64_t begin,
                                                  std::uint64_t end,
                                                  const MakeRow& make_row,
                                                  Block& block) {
  using Row = std::invoke_result_t<MakeRow, std::uint64_t>;
  static_assert(std::is_trivially_copyable_v<Row>);
  std::byte* place = block.data();
  for (std::uint64_t i = begin; i < end; ++i, place += sizeof(Row)) {
    const Row row = make_row(i);
    std::memcpy(place, &row, sizeof(Row));
  }
  return {block.data(), place};
}

template <class MakeRow>
void BlockWriter::rows(std::uint64_t count, const MakeRow& make_row) {
  constexpr std::uint64_t kRowsPerBlock =
      kBlockBytes / sizeof(std::invoke_result_t<MakeRow, std::uint64_t>);
  const Turn block(*blocks_);
  for (std::uint64_t begin = 0; begin < count && status_.ok(); begin += kRowsPerBlock) {
    write_block(make_rows(begin, std::min(begin + kRowsPerBlock, count), make_row, *block));
  }
}

template <class MakeRow>
void BlockWriter::rows_side_by_side(std::uint64_t count, const MakeRow& make_row) {
  constexpr std::uint64_t kRowBytes = sizeof(std::invoke_result_t<MakeRow, std::uint64_t>);
  constexpr std::uint64_t kRowsPerBlock = kBlockBytes / kRowBytes;
  if (count <= kRowsPerBlock) return rows(count, make_row);
  const std::uint64_t blocks = (count + kRowsPerBlock - 1) / kRowsPerBlock;
  for (std::uint64_t first = 0; first < blocks && status_.ok(); first += kBlocksAtOnce) {
    if (is_cancelled()) return;
    std::array<absl::Status, kBlocksAtOnce> outcomes;
    for_each_index(std::min(kBlocksAtOnce, blocks - first), [&](std::size_t i) {
      const std::uint64_t begin = (first + i) * kRowsPerBlock;
      const Turn block(*blocks_);
      outcomes[i] = file_.write_at(
          position_ + begin * kRowBytes,
          make_rows(begin, std::min(begin + kRowsPerBlock, count), make_row, *block));
    });
    for (const absl::Status& outcome : outcomes) status_.Update(outcome);
    const std::uint64_t end = std::min((first + kBlocksAtOnce) * kRowsPerBlock, count);
    tell_progress((end - first * kRowsPerBlock) * kRowBytes);
  }
  position_ += count * kRowBytes;
}

template <class WriteLine>
void BlockWriter::lines(std::uint64_t count,
                        std::uint64_t nominal_bytes,
                        const WriteLine& write_line) {
  const Turn block(*blocks_);
  char* const begin = reinterpret_cast<char*>(block->data());
  char* const full = begin + kBlockBytes - kMostLineBytes;
  for (std::uint64_t i = 0; i < count && status_.ok();) {
    const std::uint64_t first = i;
    char* place = begin;
    while (i < count && place < full) place = write_line(i++, place);
    write_block({block->data(), static_cast<std::size_t>(place - begin)},
                (i - first) * nominal_bytes);
  }
}

}  // namespace tet
