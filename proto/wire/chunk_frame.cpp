#include "proto/wire/chunk_frame.h"

#include "proto/wire/field_writer.h"

namespace tet {

namespace {

constexpr std::size_t kRoomForNumbers = 2 * ChunkFrame::kAlignment;
static_assert(kRoomForNumbers >= FieldWriter::kCapacity);

constexpr std::size_t aligned(std::size_t offset) noexcept {
  return (offset + ChunkFrame::kAlignment - 1) / ChunkFrame::kAlignment *
         ChunkFrame::kAlignment;
}

constexpr std::array<std::uint32_t, ChunkFrame::kColumns> kFieldOfColumn = {
    chunk_field::kPositions, chunk_field::kTets,  chunk_field::kRegions,
    chunk_field::kFields,    chunk_field::kFaces, chunk_field::kFaceTets,
    chunk_field::kFaceLabels};
constexpr std::size_t kFacesColumn = 4;

FieldWriter write_numbers(const ChunkNumbers& numbers) noexcept {
  FieldWriter writer;
  writer.number(chunk_field::kIndex, numbers.index);
  writer.number(chunk_field::kFirstVertex, numbers.first_vertex);
  writer.number(chunk_field::kVertexCount, numbers.vertex_count);
  writer.number(chunk_field::kFirstTet, numbers.first_tet);
  writer.number(chunk_field::kTetCount, numbers.tet_count);
  writer.fixed32(chunk_field::kChecksum, numbers.checksum);
  return writer;
}

}  // namespace

ChunkFrame::ChunkFrame(const std::array<std::size_t, kColumns>& column_bytes) noexcept
    : bytes_(column_bytes) {
  std::size_t room = kRoomForNumbers;
  for (std::size_t i = 0; i < bytes_.size(); ++i) {
    begin_[i] = aligned(end_ + room);
    end_ = begin_[i] + bytes_[i];
    room = kAlignment;  // for two numbers, a tag and a size: 34 bytes at most
  }
}

std::array<ChunkFrame::Part, ChunkFrame::kColumns> ChunkFrame::write(
    std::byte* block, const ChunkNumbers& numbers) const noexcept {
  std::array<FieldWriter, kColumns> before;
  before[0] = write_numbers(numbers);
  before[kFacesColumn].number(chunk_field::kFirstFace, numbers.first_face);
  before[kFacesColumn].number(chunk_field::kFaceCount, numbers.face_count);
  std::size_t chunk_bytes = 0;
  for (std::size_t i = 0; i < bytes_.size(); ++i) {
    before[i].bytes(kFieldOfColumn[i], bytes_[i]);
    chunk_bytes += before[i].size() + bytes_[i];
  }
  FieldWriter event;
  event.message(chunk_field::kEvent, chunk_bytes);
  event.append(before[0]);
  before[0] = event;

  std::array<Part, kColumns> parts;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    before[i].copy_before(block + begin_[i]);
    parts[i] = {begin_[i] - before[i].size(), begin_[i] + bytes_[i]};
  }
  return parts;
}

}  // namespace tet
