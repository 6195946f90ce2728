#include "core/base/posix/transfer.h"

#include <cerrno>
#include <unistd.h>

namespace tet {
namespace {

/// Calls `step(done)`, which moves some bytes from the `done`-th on, until all `size` are
/// moved. How many were: fewer when a step says that there are no more (0) or fails (-1).
template <class Step>
std::size_t move_bytes(std::size_t size, const Step& step) noexcept {
  std::size_t done = 0;
  while (done < size) {
    const ssize_t count = step(done);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    done += static_cast<std::size_t>(count);
  }
  return done;
}

}  // namespace

std::int64_t read_all_at(int descriptor,
                         std::uint64_t offset,
                         std::span<std::byte> into) noexcept {
  ssize_t last = 0;
  const std::size_t done = move_bytes(into.size(), [&](std::size_t from) {
    last = ::pread(descriptor, into.data() + from, into.size() - from,
                   static_cast<off_t>(offset + from));
    return last;
  });
  return done == 0 && last < 0 ? -1 : static_cast<std::int64_t>(done);
}

std::int64_t read_what_came(int descriptor, std::span<char> into) noexcept {
  for (;;) {
    const ssize_t count = ::read(descriptor, into.data(), into.size());
    if (count >= 0 || errno != EINTR) return count;
  }
}

bool write_all_at(int descriptor,
                  std::uint64_t offset,
                  std::span<const std::byte> bytes) noexcept {
  return bytes.size() == move_bytes(bytes.size(), [&](std::size_t from) {
           return ::pwrite(descriptor, bytes.data() + from, bytes.size() - from,
                           static_cast<off_t>(offset + from));
         });
}

bool write_all(int descriptor, std::span<const std::byte> bytes) noexcept {
  return bytes.size() == move_bytes(bytes.size(), [&](std::size_t from) {
           return ::write(descriptor, bytes.data() + from, bytes.size() - from);
         });
}

}  // namespace tet
