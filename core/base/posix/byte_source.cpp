#include "core/base/posix/byte_source.h"

#include <algorithm>

#include "core/base/posix/transfer.h"

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
  const std::int64_t count = read_all_at(descriptor_, offset, into);
  return into.first(static_cast<std::size_t>(std::max<std::int64_t>(count, 0)));
}

}  // namespace tet
