// Columns one after another in one block of bytes: what processes hand to each other.
//
// A block is a header and then columns, each at the next multiple of 64 bytes, with zeros
// between. Numbers are as this machine has them: a block never leaves it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include <absl/status/status.h>

#include "core/base/cancel.h"

namespace tet {

inline constexpr std::size_t kColumnAlignment = 64;

/// Bytes that a column of `bytes` takes in a block.
constexpr std::uint64_t column_bytes(std::uint64_t bytes) {
  return (bytes + kColumnAlignment - 1) / kColumnAlignment * kColumnAlignment;
}

/// Takes a block's bytes, piece by piece.
using ByteSink = std::function<absl::Status(std::span<const std::byte>)>;

/// Writes a block's columns. After an error of the sink nothing more is written.
class FlatWriter {
 public:
  explicit FlatWriter(const ByteSink& sink) : sink_(sink) {}

  template <class T>
  void add(std::span<const T> column) {
    static_assert(std::is_trivially_copyable_v<T>);
    add_bytes(std::as_bytes(column));
  }
  const absl::Status& status() const { return status_; }

 private:
  void add_bytes(std::span<const std::byte> bytes);
  void write(std::span<const std::byte> bytes);

  const ByteSink& sink_;
  absl::Status status_;
};

/// Reads a block's columns in their order, and believes nothing it says.
class FlatReader {
 public:
  /// The block stays where it is for as long as its columns are read.
  explicit FlatReader(std::span<const std::byte> block);

  /// The next column: `count` rows of `width` items each; nothing when the block has no room
  /// for so many, or something lies between columns.
  template <class T>
  std::optional<std::span<const T>> column(std::uint64_t count, std::uint64_t width = 1) {
    static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= kColumnAlignment);
    if (count > rest_.size() / sizeof(T) / width) return std::nullopt;
    const auto items = static_cast<std::size_t>(count * width);
    const std::byte* const first = rest_.data();
    if (!skip(items * sizeof(T))) return std::nullopt;
    return std::span<const T>(reinterpret_cast<const T*>(first), items);
  }

  bool at_end() const { return rest_.empty(); }

 private:
  bool skip(std::size_t bytes);

  std::span<const std::byte> rest_;
};

/// Copies a column. Looks at `cancellation` after each mebibyte: once it is requested, what was
/// copied is not whole.
template <class T>
void copy_column(std::span<const T> from,
                 const Cancellation& cancellation,
                 std::vector<T>& to) {
  constexpr std::size_t kAtOnce = (std::size_t{1} << 20) / sizeof(T);
  to.reserve(from.size());
  while (!from.empty() && !cancellation.requested()) {
    const auto some = from.first(std::min(kAtOnce, from.size()));
    to.insert(to.end(), some.begin(), some.end());
    from = from.subspan(some.size());
  }
}

}  // namespace tet
