// The protobuf bytes around a chunk's columns, so that these are sent from where they were
// made.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace tet {

/// Numbers of MeshEvent's and MeshChunk's fields.
namespace chunk_field {
inline constexpr std::uint32_t kEvent = 3;  ///< MeshEvent.chunk
inline constexpr std::uint32_t kIndex = 1;
inline constexpr std::uint32_t kFirstVertex = 2;
inline constexpr std::uint32_t kVertexCount = 3;
inline constexpr std::uint32_t kFirstTet = 4;
inline constexpr std::uint32_t kTetCount = 5;
inline constexpr std::uint32_t kChecksum = 6;
inline constexpr std::uint32_t kPositions = 7;
inline constexpr std::uint32_t kTets = 8;
inline constexpr std::uint32_t kRegions = 9;
inline constexpr std::uint32_t kFields = 11;
inline constexpr std::uint32_t kFirstFace = 13;
inline constexpr std::uint32_t kFaceCount = 14;
inline constexpr std::uint32_t kFaces = 15;
inline constexpr std::uint32_t kFaceTets = 16;
inline constexpr std::uint32_t kFaceLabels = 17;
}  // namespace chunk_field

/// A MeshChunk but for its columns.
struct ChunkNumbers {
  std::uint64_t index = 0;
  std::uint64_t first_vertex = 0, vertex_count = 0;
  std::uint64_t first_tet = 0, tet_count = 0;
  std::uint32_t checksum = 0;
  std::uint64_t first_face = 0, face_count = 0;
};

/// A MeshEvent with a MeshChunk, laid out in one block of memory: columns at aligned places,
/// and just before each the bytes that protobuf wants there. What lies between is not sent.
///
///     ....event and numbers, tag|positions....tag|tets....tag|regions....tag|fields
///     ....numbers of faces, tag|faces....tag|their tets....tag|their labels
class ChunkFrame {
 public:
  /// Columns begin at multiples of this, if the block does.
  static constexpr std::size_t kAlignment = 64;
  /// Positions, tets, regions, fields, and faces with their tets and labels, in the order in
  /// which they are sent.
  static constexpr std::size_t kColumns = 7;

  /// More than `block_bytes` exceeds the columns' own sizes by.
  static constexpr std::size_t kMaxOverhead = 2 * kColumns * kAlignment;

  /// Sizes of the columns, bytes.
  explicit ChunkFrame(const std::array<std::size_t, kColumns>& column_bytes) noexcept;

  /// Size of the memory that holds it all.
  std::size_t block_bytes() const noexcept { return end_; }

  /// Where the columns go; `block` has `block_bytes`.
  std::span<std::byte> column(std::byte* block, std::size_t i) const noexcept {
    return {block + begin_[i], bytes_[i]};
  }

  /// A run of bytes within the block.
  struct Part {
    std::size_t begin = 0, end = 0;
  };

  /// Writes what protobuf wants before each column. The parts, one after another, are the
  /// message as protobuf itself would write it; those of empty columns may be empty.
  std::array<Part, kColumns> write(std::byte* block,
                                   const ChunkNumbers& numbers) const noexcept;

 private:
  std::array<std::size_t, kColumns> bytes_;
  std::array<std::size_t, kColumns> begin_{};
  std::size_t end_ = 0;
};

}  // namespace tet
