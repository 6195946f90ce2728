#include "server/grids/grid_upload.h"

#include <algorithm>
#include <vector>

#include <absl/strings/str_cat.h>

#include "proto/convert/status.h"

namespace tet {

namespace {
// The disk begins with so much at a time while the rest is still coming.
constexpr std::uint64_t kFlushBytes = std::uint64_t{16} << 20;
constexpr std::size_t kPartReadBytes = std::size_t{1} << 20;
}  // namespace

absl::StatusOr<std::unique_ptr<GridUpload>> GridUpload::open(GridStore& store,
                                                             GridKey key,
                                                             std::uint64_t size_bytes,
                                                             File part) {
  std::unique_ptr<GridUpload> upload(
      new GridUpload(store, std::move(key), size_bytes, std::move(part)));
  const absl::Status status = upload->measure_part();
  if (!status.ok()) return status;
  return upload;
}

absl::Status GridUpload::measure_part() {
  const absl::StatusOr<std::uint64_t> size = file_.size();
  if (!size.ok()) return size.status();
  // More than the whole file: whatever announced another size is not to be resumed.
  if (*size > size_bytes_) return file_.truncate(0);
  part_size_ = *size;
  return absl::OkStatus();
}

absl::Status GridUpload::digest_part(std::uint64_t most_bytes) {
  std::vector<char> buffer(kPartReadBytes);
  const std::uint64_t end =
      committed_size_ + std::min(most_bytes, part_size_ - committed_size_);
  while (committed_size_ < end) {
    const std::span<char> room =
        std::span(buffer).first(std::min<std::uint64_t>(kPartReadBytes, end - committed_size_));
    const absl::StatusOr<std::size_t> count = file_.read_at(committed_size_, room);
    if (!count.ok()) return count.status();
    if (*count == 0) part_size_ = committed_size_;  // somebody has cut it
    if (*count == 0) break;
    sha256_.add(std::string_view(buffer.data(), *count));
    committed_size_ += *count;
  }
  return absl::OkStatus();
}

// What was not digested is as good as it was before.
GridUpload::~GridUpload() {
  if (!kept_) store_.end_upload(key_, std::max(committed_size_, part_size_));
}

absl::Status GridUpload::append(std::uint64_t offset, std::string_view bytes) {
  absl::Status status = check(offset, bytes.size());
  if (status.ok()) status = write({&bytes, 1});
  if (!status.ok()) return status;
  digest({&bytes, 1});
  advance(bytes.size());
  return absl::OkStatus();
}

absl::Status GridUpload::check(std::uint64_t offset, std::uint64_t size) const {
  if (offset != committed_size_) {
    return with_reason(absl::OutOfRangeError(absl::StrCat(
                           "offset ", offset, " is not the committed size ", committed_size_)),
                       "WRONG_OFFSET");
  }
  if (size > size_bytes_ - committed_size_) {
    return with_reason(
        absl::InvalidArgumentError(absl::StrCat(
            "data ends at ", offset + size, ", beyond the announced ", size_bytes_, " bytes")),
        "TOO_MUCH_DATA");
  }
  return absl::OkStatus();
}

absl::Status GridUpload::write(std::span<const std::string_view> bytes) {
  std::uint64_t offset = committed_size_;
  absl::Status written;
  for (auto part = bytes.begin(); part != bytes.end() && written.ok(); ++part) {
    written = file_.write_at(offset, *part);
    offset += part->size();
  }
  if (!written.ok()) {
    // Only whole pieces count as committed: cut off what the disk took of this one.
    const absl::Status cut = file_.truncate(committed_size_);
    return cut.ok() ? written : cut;
  }
  if (offset / kFlushBytes > committed_size_ / kFlushBytes) {
    file_.begin_flush(offset / kFlushBytes * kFlushBytes - kFlushBytes, kFlushBytes);
  }
  return absl::OkStatus();
}

void GridUpload::digest(std::span<const std::string_view> bytes) noexcept {
  for (const std::string_view part : bytes) sha256_.add(part);
}

absl::Status GridUpload::commit() {
  const std::string found = sha256_.finish_hex();
  if (found != key_.digest) {
    committed_size_ = part_size_ = 0;  // so that the store throws it away
    return with_reason(
        absl::InvalidArgumentError(absl::StrCat("the data's SHA-256 is ", found, ", not ",
                                                key_.digest, " as announced")),
        "WRONG_DIGEST");
  }
  absl::Status status = file_.sync();
  if (status.ok()) status = store_.keep(key_, size_bytes_);
  kept_ = status.ok();
  // Whoever wants the grid shares its lock from now on.
  if (kept_) file_.close().IgnoreError();
  return status;
}

}  // namespace tet
