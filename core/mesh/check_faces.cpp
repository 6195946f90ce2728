#include "core/mesh/check_faces.h"

#include <cstring>
#include <utility>

namespace tet {
namespace {

template <class Number, std::size_t N>
std::array<Number, N> numbers_at(std::span<const std::byte> column,
                                 std::uint64_t row) noexcept {
  std::array<Number, N> numbers;
  std::memcpy(numbers.data(), column.data() + row * sizeof(numbers), sizeof(numbers));
  return numbers;
}

/// The corner of a tet that a face is opposite of, or 4.
template <class Id>
std::size_t opposite_of(const std::array<Id, 3>& face, const std::array<Id, 4>& tet) noexcept {
  std::size_t k = 0;
  for (; k < kFaceCorners.size(); ++k) {
    const auto& [a, b, c] = kFaceCorners[k];
    if (face[0] == tet[a] && face[1] == tet[b] && face[2] == tet[c]) break;
  }
  return k;
}

template <class Id>
bool are_of_tets(const MeshHeader& header,
                 const ChunkExtent& chunk,
                 const ConstColumns& columns) noexcept {
  std::uint64_t least = 0;  // 4 * tet + corner of the next face
  for (std::uint64_t i = 0; i < chunk.face_count; ++i) {
    const std::uint64_t tet = numbers_at<Id, 1>(columns.face_tets, i)[0] - chunk.first_tet;
    if (tet >= chunk.tet_count) return false;
    const std::size_t opposite =
        opposite_of(numbers_at<Id, 3>(columns.faces, i), numbers_at<Id, 4>(columns.tets, tet));
    if (opposite == 4 || 4 * tet + opposite < least) return false;
    least = 4 * tet + opposite + 1;
    const auto label = numbers_at<std::uint16_t, 1>(columns.face_labels, i)[0];
    if (label >= header.face_labels.size()) return false;
  }
  return true;
}

}  // namespace

bool faces_are_of_tets(const MeshHeader& header,
                       const ChunkExtent& chunk,
                       const ConstColumns& columns) noexcept {
  return header.index_type == IndexType::kUint64
             ? are_of_tets<std::uint64_t>(header, chunk, columns)
             : are_of_tets<std::uint32_t>(header, chunk, columns);
}

}  // namespace tet
