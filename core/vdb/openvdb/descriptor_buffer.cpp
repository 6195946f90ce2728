#include "core/vdb/openvdb/descriptor_buffer.h"

#include <algorithm>
#include <cstddef>
#include <span>

#include "core/base/posix/transfer.h"

namespace tet {

std::int64_t DescriptorBuffer::read(char* bytes, std::int64_t count) {
  const std::int64_t wanted = std::min(count, size_ - end_);
  const std::span into(bytes, static_cast<std::size_t>(wanted));
  const std::int64_t got =
      read_all_at(descriptor_, static_cast<std::uint64_t>(end_), std::as_writable_bytes(into));
  end_ += std::max<std::int64_t>(got, 0);
  return std::max<std::int64_t>(got, 0);
}

DescriptorBuffer::int_type DescriptorBuffer::underflow() {
  if (gptr() == egptr()) {
    const std::int64_t count = read(bytes_.data(), std::ssize(bytes_));
    setg(bytes_.data(), bytes_.data(), bytes_.data() + count);
  }
  return gptr() == egptr() ? traits_type::eof() : traits_type::to_int_type(*gptr());
}

std::streamsize DescriptorBuffer::xsgetn(char* bytes, std::streamsize count) {
  std::streamsize done = 0;
  while (done < count) {
    std::streamsize step = std::min<std::streamsize>(egptr() - gptr(), count - done);
    if (step > 0) {
      std::copy_n(gptr(), step, bytes + done);
      setg(eback(), gptr() + step, egptr());
    } else if (count - done >= std::ssize(bytes_)) {  // too much to copy twice
      setg(bytes_.data(), bytes_.data(), bytes_.data());
      step = read(bytes + done, count - done);
      if (step == 0) break;
    } else if (underflow() == traits_type::eof()) {
      break;
    }
    done += step;
  }
  return done;
}

DescriptorBuffer::pos_type DescriptorBuffer::seekoff(off_type offset,
                                                     std::ios_base::seekdir from,
                                                     std::ios_base::openmode which) {
  const std::int64_t base = from == std::ios_base::beg   ? 0
                            : from == std::ios_base::cur ? position()
                                                         : size_;
  std::int64_t target = 0;
  if (__builtin_add_overflow(base, offset, &target)) return off_type{-1};
  return seekpos(target, which);
}

DescriptorBuffer::pos_type DescriptorBuffer::seekpos(pos_type position,
                                                     std::ios_base::openmode) {
  const std::int64_t target = position;
  if (target < 0 || target > size_) return off_type{-1};
  const std::int64_t start = end_ - (egptr() - eback());
  if (target >= start && target <= end_) {
    setg(eback(), eback() + (target - start), egptr());
  } else {
    setg(bytes_.data(), bytes_.data(), bytes_.data());
    end_ = target;
  }
  return position;
}

}  // namespace tet
