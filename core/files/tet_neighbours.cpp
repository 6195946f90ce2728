#include "core/files/tet_neighbours.h"

#include <algorithm>
#include <span>
#include <tuple>

#include "core/base/parallel.h"

namespace tet {
namespace {

/// A face of a tet whose lowest vertex is known from where it stands.
struct SeenFace {
  std::uint32_t middle = 0, high = 0;
  std::uint64_t index = 0;  ///< see TetFace
};

/// As many faces are looked at at once: at least so many, and at most a sixteenth of all.
constexpr std::uint64_t kFacesAtOnce = std::uint64_t{1} << 22;

/// Tets between two looks at the cancellation: some milliseconds.
constexpr std::uint64_t kTetsPerLook = std::uint64_t{1} << 17;

/// False where the cancellation was requested before all faces had been visited.
template <class Visit>
bool visit_faces(const TetMesh& mesh, const Cancellation& cancellation, const Visit& visit) {
  for (std::uint64_t begin = 0; begin < mesh.header.tet_count; begin += kTetsPerLook) {
    if (cancellation.requested()) return false;
    const std::uint64_t end = std::min(begin + kTetsPerLook, mesh.header.tet_count);
    for (std::uint64_t tet = begin; tet < end; ++tet) {
      const auto corners = mesh.tet(tet);
      for (std::size_t k = 0; k < 4; ++k) {
        visit(sort_face(face_of(corners, k)).vertices, 4 * tet + k);
      }
    }
  }
  return true;
}

/// Pairs the faces with one lowest vertex: those with the same others are one.
void pair_faces(std::span<SeenFace> faces, std::span<std::uint32_t> behind) {
  std::ranges::sort(faces, [](const SeenFace& a, const SeenFace& b) {
    return std::tie(a.middle, a.high, a.index) < std::tie(b.middle, b.high, b.index);
  });
  for (std::size_t i = 1; i < faces.size(); ++i) {
    const SeenFace &a = faces[i - 1], &b = faces[i];
    if (std::tie(a.middle, a.high) != std::tie(b.middle, b.high)) continue;
    behind[a.index] = static_cast<std::uint32_t>(b.index / 4);
    behind[b.index] = static_cast<std::uint32_t>(a.index / 4);
  }
}

}  // namespace

TetNeighbours::TetNeighbours(const TetMesh& mesh, const Cancellation& cancellation)
    : behind_(4 * mesh.header.tet_count, kNone) {
  if (!find(mesh, cancellation)) behind_.clear();
  const auto inner = std::ranges::count_if(behind_, [](auto tet) { return tet != kNone; });
  inner_faces_ = static_cast<std::uint64_t>(inner) / 2;
}

bool TetNeighbours::find(const TetMesh& mesh, const Cancellation& cancellation) {
  const std::uint64_t vertices = mesh.header.vertex_count;
  std::vector<std::uint64_t> first(vertices + 1);  // faces before those of each lowest vertex
  const auto count_face = [&](const Triangle& face, std::uint64_t) { ++first[face[0] + 1]; };
  if (!visit_faces(mesh, cancellation, count_face)) return false;
  for (std::uint64_t v = 0; v < vertices; ++v) first[v + 1] += first[v];
  const std::uint64_t at_once = std::max(kFacesAtOnce, behind_.size() / 16);
  std::vector<SeenFace> faces;
  std::vector<std::uint64_t> next;
  for (std::uint64_t begin = 0, end = 0; begin < vertices; begin = end) {
    // As many vertices as have that many faces, and one at least.
    const auto after = std::ranges::upper_bound(first, first[begin] + at_once);
    end = std::max(begin + 1, static_cast<std::uint64_t>(after - first.begin()) - 1);
    faces.resize(first[end] - first[begin]);
    next.assign(first.begin() + static_cast<std::ptrdiff_t>(begin),
                first.begin() + static_cast<std::ptrdiff_t>(end));
    const auto keep_face = [&](const Triangle& face, std::uint64_t index) {
      if (face[0] < begin || face[0] >= end) return;
      faces[next[face[0] - begin]++ - first[begin]] = {
          static_cast<std::uint32_t>(face[1]), static_cast<std::uint32_t>(face[2]), index};
    };
    if (!visit_faces(mesh, cancellation, keep_face)) return false;
    for_each_index(end - begin, [&](std::size_t i) {
      const std::uint64_t from = first[begin + i] - first[begin];
      const std::uint64_t count = first[begin + i + 1] - first[begin + i];
      pair_faces(std::span(faces).subspan(from, count), behind_);
    });
  }
  return true;
}

}  // namespace tet
