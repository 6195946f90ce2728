#include "core/vdb/byte_source.h"

#include <algorithm>
#include <cerrno>
#include <unistd.h>

namespace tet {

std::span<const std::byte> ByteSource::window(std::uint64_t offset,
                                              std::size_t window_bytes,
                                              std::vector<std::byte>& buffer) const {
  if (offset >= size_) return {};
  if (descriptor_ < 0) return bytes_.subspan(offset);
  const std::uint64_t wanted = std::min<std::uint64_t>(window_bytes, size_ - offset);
  if (buffer.size() < wanted) buffer.resize(wanted);
  return read_file(offset, std::span(buffer).first(wanted));
}

std::span<const std::byte> ByteSource::read_file(std::uint64_t offset,
                                                 std::span<std::byte> into) const {
  std::size_t read = 0;
  while (read < into.size()) {
    const ssize_t n = ::pread(descriptor_, into.data() + read, into.size() - read,
                              static_cast<off_t>(offset + read));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    read += static_cast<std::size_t>(n);
  }
  return into.first(read);
}

}  // namespace tet
