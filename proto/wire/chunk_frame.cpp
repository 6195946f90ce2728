#include "proto/wire/chunk_frame.h"

#include <cstring>

namespace tet {

namespace {

/// The first bytes of a message, as protobuf writes them: fields that are 0 are left out.
class FieldWriter {
 public:
  void varint(std::uint64_t value) noexcept {
    for (; value >= 0x80; value >>= 7) put(static_cast<std::uint8_t>(value | 0x80));
    put(static_cast<std::uint8_t>(value));
  }
  void number(ChunkField field, std::uint64_t value) noexcept {
    if (value == 0) return;
    varint(tag_of(field, FieldCoding::kVarint));
    varint(value);
  }
  void checksum(std::uint32_t value) noexcept {
    if (value == 0) return;
    varint(tag_of(ChunkField::kChecksum, FieldCoding::kFixed32));
    for (int shift = 0; shift < 32; shift += 8) put(static_cast<std::uint8_t>(value >> shift));
  }
  /// Announces bytes that follow; columns that are empty are left out.
  void bytes(ChunkField field, std::uint64_t size) noexcept {
    if (size == 0 && field != ChunkField::kEvent) return;
    varint(tag_of(field, FieldCoding::kBytes));
    varint(size);
  }
  void append(const FieldWriter& other) noexcept {
    std::memcpy(bytes_.data() + size_, other.bytes_.data(), other.size_);
    size_ += other.size_;
  }

  std::size_t size() const noexcept { return size_; }
  void copy_to_end_at(std::byte* end) const noexcept {
    std::memcpy(end - size_, bytes_.data(), size_);
  }

 private:
  void put(std::uint8_t byte) noexcept { bytes_[size_++] = std::byte{byte}; }

  // Six tags of one byte, six varints of at most ten and a fixed32 are 70, and two more tags.
  std::array<std::byte, 2 * ChunkFrame::kAlignment> bytes_;
  std::size_t size_ = 0;
};

constexpr std::size_t aligned(std::size_t offset) noexcept {
  return (offset + ChunkFrame::kAlignment - 1) / ChunkFrame::kAlignment *
         ChunkFrame::kAlignment;
}

constexpr std::array kColumns = {ChunkField::kPositions, ChunkField::kTets,
                                 ChunkField::kRegions};

FieldWriter write_numbers(const ChunkNumbers& numbers) noexcept {
  FieldWriter writer;
  writer.number(ChunkField::kIndex, numbers.index);
  writer.number(ChunkField::kFirstVertex, numbers.first_vertex);
  writer.number(ChunkField::kVertexCount, numbers.vertex_count);
  writer.number(ChunkField::kFirstTet, numbers.first_tet);
  writer.number(ChunkField::kTetCount, numbers.tet_count);
  writer.checksum(numbers.checksum);
  return writer;
}

}  // namespace

ChunkFrame::ChunkFrame(const std::array<std::size_t, 3>& column_bytes) noexcept
    : bytes_(column_bytes) {
  std::size_t room = 2 * kAlignment;  // for the numbers
  for (std::size_t i = 0; i < bytes_.size(); ++i) {
    begin_[i] = aligned(end_ + room);
    end_ = begin_[i] + bytes_[i];
    room = kAlignment;  // for a tag and a size, 11 bytes at most
  }
}

std::array<ChunkFrame::Part, 3> ChunkFrame::write(std::byte* block,
                                                  const ChunkNumbers& numbers) const noexcept {
  std::array<FieldWriter, 3> before;
  before[0] = write_numbers(numbers);
  std::size_t chunk_bytes = 0;
  for (std::size_t i = 0; i < bytes_.size(); ++i) {
    before[i].bytes(kColumns[i], bytes_[i]);
    chunk_bytes += before[i].size() + bytes_[i];
  }
  FieldWriter event;
  event.bytes(ChunkField::kEvent, chunk_bytes);
  event.append(before[0]);
  before[0] = event;

  std::array<Part, 3> parts;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    before[i].copy_to_end_at(block + begin_[i]);
    parts[i] = {begin_[i] - before[i].size(), begin_[i] + bytes_[i]};
  }
  return parts;
}

}  // namespace tet
