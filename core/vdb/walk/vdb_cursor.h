// Reading a .vdb file from its first byte to its last, never beyond.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/base/posix/byte_source.h"

namespace tet {

/// A piece of a file that the walker looked at: where, and as what.
struct VdbField {
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;
  const char* what = "";  ///< a literal
};

/// A place in a file, moving forward. Throws WalkRefusal rather than go past the end, or go on
/// when `cancelled`, if there is one, says so: it is asked whenever bytes are read.
///
/// `what` names a field in refusals, and in `fields` when that is given (for mutators).
class VdbCursor {
 public:
  /// The most bytes that `take` gives at once: the two masks of an upper node fit.
  static constexpr std::size_t kMostBytes = 8192;

  explicit VdbCursor(const ByteSource& source,
                     std::vector<VdbField>* fields = nullptr,
                     std::function<bool()> cancelled = nullptr)
      : source_(source), fields_(fields), cancelled_(std::move(cancelled)) {}

  /// Another place in the same file, at its beginning, whose fields are not noted.
  VdbCursor beside() const { return VdbCursor(source_, nullptr, cancelled_); }

  std::uint64_t position() const noexcept { return begin_ + used_; }
  std::uint64_t left() const noexcept { return source_.size() - position(); }

  /// The next `bytes` bytes, at most kMostBytes; they stay until the next call.
  const std::byte* take(std::size_t bytes, const char* what) {
    if (fields_ != nullptr) note(bytes, what);
    if (window_.size() - used_ < bytes) refill(bytes, what);
    used_ += bytes;
    return window_.data() + used_ - bytes;
  }

  template <class T>
  T read(const char* what) {
    static_assert(std::is_trivially_copyable_v<T> &&
                  std::endian::native == std::endian::little);
    T value;
    std::memcpy(&value, take(sizeof(T), what), sizeof(T));
    return value;
  }

  /// A string after its length, which may not exceed `most`. `text` names its characters.
  std::string read_string(std::size_t most, const char* what, const char* text);

  void skip(std::uint64_t bytes, const char* what);

  /// Moves on to `position`, which is neither before this one nor beyond the end.
  void move_to(std::uint64_t position);

 private:
  void note(std::uint64_t bytes, const char* what);
  void refill(std::size_t bytes, const char* what);
  void check_left(std::uint64_t bytes, const char* what) const;

  ByteSource source_;
  std::vector<VdbField>* fields_;
  std::function<bool()> cancelled_;
  std::vector<std::byte> buffer_;
  std::span<const std::byte> window_;
  std::uint64_t begin_ = 0;  // of the window, in the file
  std::size_t used_ = 0;     // of the window
};

}  // namespace tet
