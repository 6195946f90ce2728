#include "core/vdb/walk/vdb_cursor.h"

#include <absl/strings/str_format.h>

#include "core/base/check.h"
#include "core/vdb/walk/walk_refusal.h"

namespace tet {
namespace {

/// Few system calls, and still within a core's own cache.
constexpr std::size_t kWindowBytes = 256 * 1024;

}  // namespace

void VdbCursor::note(std::uint64_t bytes, const char* what) {
  fields_->push_back({position(), bytes, what});
}

void VdbCursor::check_left(std::uint64_t bytes, const char* what) const {
  if (bytes <= left()) return;
  refuse_at(position(),
            absl::StrFormat("the file ends within the %s: it takes %d bytes and %d are left",
                            what, bytes, left()));
}

void VdbCursor::refill(std::size_t bytes, const char* what) {
  TET_CHECK(bytes <= kMostBytes);
  check_left(bytes, what);
  if (cancelled_ && cancelled_()) throw WalkRefusal(absl::CancelledError("cancelled"));
  begin_ = position();
  used_ = 0;
  window_ = source_.window(begin_, kWindowBytes, buffer_);
  if (window_.size() < bytes) refuse_at(begin_, "the file could not be read, or was cut");
}

std::string VdbCursor::read_string(std::size_t most, const char* what, const char* text) {
  const std::uint64_t start = position();
  const auto length = read<std::uint32_t>(what);
  if (length > most) {
    refuse_at(start, absl::StrFormat("the %s claims %d characters; the limit is %d", what,
                                     length, most));
  }
  const std::byte* bytes = take(length, text);
  return {reinterpret_cast<const char*>(bytes), length};
}

void VdbCursor::skip(std::uint64_t bytes, const char* what) {
  if (fields_ != nullptr) note(bytes, what);
  check_left(bytes, what);
  move_to(position() + bytes);
}

void VdbCursor::move_to(std::uint64_t position) {
  TET_CHECK(position >= this->position() && position <= source_.size());
  if (position - begin_ <= window_.size()) {
    used_ = static_cast<std::size_t>(position - begin_);
    return;
  }
  begin_ = position;
  used_ = 0;
  window_ = {};
}

}  // namespace tet
