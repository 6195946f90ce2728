#include "core/image/inflate.h"

#include <algorithm>
#include <new>

#include <zlib.h>

#include "core/image/image_refusal.h"

namespace tet {
namespace {

constexpr std::size_t kWindowBytes = std::size_t{256} << 10;
constexpr int kZlibOrGzip = 15 + 32;
constexpr Bytef kGzipBegins = 0x1f;

/// zlib counts in unsigned ints.
constexpr std::size_t kMostAtOnce = std::size_t{1} << 30;

[[noreturn]] void refuse_stream() {
  refuse_image("its packed data are broken or truncated: unpacking them fails");
}

}  // namespace

Inflater::Inflater(const ByteSource& source, std::uint64_t offset, std::uint64_t bytes)
    : source_(source), at_(offset), end_(offset + bytes), stream_(new z_stream_s{}) {
  if (::inflateInit2(stream_.get(), kZlibOrGzip) != Z_OK) throw std::bad_alloc();
}

Inflater::~Inflater() { ::inflateEnd(stream_.get()); }

bool Inflater::refill() {
  const auto wanted =
      static_cast<std::size_t>(std::min<std::uint64_t>(kWindowBytes, end_ - at_));
  const std::span<const std::byte> bytes = source_.window(at_, wanted, window_);
  const std::size_t count = std::min(bytes.size(), wanted);
  if (count == 0) return false;
  at_ += count;
  stream_->next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(bytes.data()));
  stream_->avail_in = static_cast<uInt>(count);
  return true;
}

/// A stream of zlib does not begin as one of gzip does: what follows it is somebody else's.
bool Inflater::begin_next_member() {
  if (!is_gzip_ || (stream_->avail_in == 0 && !refill())) return false;
  return *stream_->next_in == kGzipBegins && ::inflateReset(stream_.get()) == Z_OK;
}

std::uint64_t Inflater::member_bytes() const noexcept { return stream_->total_out; }

std::size_t Inflater::read(std::span<std::byte> into) {
  std::size_t filled = 0;
  while (filled < into.size() && !done_) {
    if (stream_->avail_in == 0 && !refill()) refuse_stream();
    if (!has_begun_) is_gzip_ = *stream_->next_in == kGzipBegins;
    has_begun_ = true;
    const std::size_t room = std::min(into.size() - filled, kMostAtOnce);
    stream_->next_out = reinterpret_cast<Bytef*>(into.data() + filled);
    stream_->avail_out = static_cast<uInt>(room);
    const int result = ::inflate(stream_.get(), Z_NO_FLUSH);
    filled += room - stream_->avail_out;
    if (result == Z_MEM_ERROR) throw std::bad_alloc();
    if (result == Z_STREAM_END) done_ = !begin_next_member();
    if (result != Z_OK && result != Z_STREAM_END && result != Z_BUF_ERROR) refuse_stream();
  }
  return filled;
}

void inflate_block(std::span<const std::byte> packed, std::span<std::byte> into) {
  auto length = static_cast<uLongf>(into.size());
  const int result = ::uncompress(reinterpret_cast<Bytef*>(into.data()), &length,
                                  reinterpret_cast<const Bytef*>(packed.data()), packed.size());
  if (result == Z_MEM_ERROR) throw std::bad_alloc();
  if (result != Z_OK || length != into.size()) refuse_stream();
}

}  // namespace tet
