// Bytes to and from descriptors, all of them: a system call may stop halfway.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace tet {

/// Reads from `offset` until `into` is full or the file ends, and says how many bytes came. A
/// failure after the first bytes shows itself at the next call; before them it is -1, and
/// `errno` tells why.
std::int64_t read_all_at(int descriptor,
                         std::uint64_t offset,
                         std::span<std::byte> into) noexcept;

/// Reads what has come, of a pipe for instance, and says how many bytes: 0 at the end, or -1 on
/// failure, also where nothing has come to a descriptor that does not wait (EAGAIN).
std::int64_t read_what_came(int descriptor, std::span<char> into) noexcept;

/// Writes all of `bytes` at `offset`. On failure it is false, `errno` tells why, and some of
/// the bytes may have been written.
bool write_all_at(int descriptor,
                  std::uint64_t offset,
                  std::span<const std::byte> bytes) noexcept;

/// Writes all of `bytes` where the descriptor stands, or at the file's end with O_APPEND. On
/// failure as `write_all_at`.
bool write_all(int descriptor, std::span<const std::byte> bytes) noexcept;

}  // namespace tet
