#include "core/remap/tet_neighbors.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "core/base/parallel.h"
#include "core/remap/tet_coordinates.h"

namespace tet {
namespace {

constexpr std::size_t kPointsPerRange = 512;

/// A tet's corners from the lowest id on.
struct CornersById {
  explicit CornersById(const std::array<std::uint32_t, 4>& tet) noexcept : id(tet) {
    order(0, 1);
    order(2, 3);
    order(0, 2);
    order(1, 3);
    order(1, 2);
  }

  std::array<std::uint32_t, 4> id;
  std::array<std::uint32_t, 4> corner{0, 1, 2, 3};
  bool is_odd = false;  ///< an odd number of exchanges made it

 private:
  void order(std::size_t a, std::size_t b) noexcept {
    if (id[a] <= id[b]) return;
    std::swap(id[a], id[b]);
    std::swap(corner[a], corner[b]);
    is_odd = !is_odd;
  }
};

/// A face at its lowest corner, and the side of it that its tet is on.
struct FaceAtPoint {
  std::uint64_t others = 0;  ///< the two higher ids
  BorderFace face;
  int side = 0;  ///< 0: its tet is flat
  friend bool operator<(const FaceAtPoint& a, const FaceAtPoint& b) noexcept {
    return std::pair(a.others, a.face.tet) < std::pair(b.others, b.face.tet);
  }
};

class NeighborFinder {
 public:
  explicit NeighborFinder(const DataMesh& mesh) : mesh_(mesh) { list_tets(); }

  void join_faces(std::vector<std::array<std::uint32_t, 4>>& across) const {
    for_each_range(mesh_.points.size(), kPointsPerRange,
                   [&](std::size_t begin, std::size_t end) {
                     std::vector<FaceAtPoint> faces;
                     for (std::size_t point = begin; point < end; ++point) {
                       gather(static_cast<std::uint32_t>(point), faces);
                       join(faces, across);
                     }
                   });
  }

 private:
  /// Lists of each point the tets that it is the lowest or the second lowest corner of: the
  /// lowest corner of a face is one of these.
  void list_tets() {
    first_.assign(mesh_.points.size() + 1, 0);
    for (const auto& tet : mesh_.tets) {
      const CornersById sorted(tet);
      ++first_[sorted.id[0] + std::size_t{1}];
      ++first_[sorted.id[1] + std::size_t{1}];
    }
    for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
    tets_.resize(first_.back());
    std::vector<std::uint64_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t i = 0; i < mesh_.tets.size(); ++i) {
      const CornersById sorted(mesh_.tets[i]);
      tets_[next[sorted.id[0]]++] = static_cast<std::uint32_t>(i);
      tets_[next[sorted.id[1]]++] = static_cast<std::uint32_t>(i);
    }
  }

  /// The faces that `point` is the lowest corner of.
  void gather(std::uint32_t point, std::vector<FaceAtPoint>& faces) const {
    faces.clear();
    for (std::uint64_t i = first_[point]; i < first_[point + std::size_t{1}]; ++i) {
      const std::uint32_t tet = tets_[i];
      const CornersById sorted(mesh_.tets[tet]);
      const double volume = six_volumes(mesh_.places(tet));
      const int sign = (volume > 0 ? 1 : volume < 0 ? -1 : 0) * (sorted.is_odd ? -1 : 1);
      const auto add = [&](std::size_t b, std::size_t c, std::size_t left_out, int side) {
        faces.push_back({std::uint64_t{sorted.id[b]} << 32 | sorted.id[c],
                         {tet, sorted.corner[left_out]},
                         side});
      };
      // Leaving out the next corner turns a face over.
      if (sorted.id[0] == point) {
        add(1, 2, 3, sign);
        add(1, 3, 2, -sign);
        add(2, 3, 1, sign);
      } else {
        add(2, 3, 0, -sign);
      }
    }
  }

  static void join(std::vector<FaceAtPoint>& faces,
                   std::vector<std::array<std::uint32_t, 4>>& across) {
    std::ranges::sort(faces, std::less<FaceAtPoint>());
    for (std::size_t i = 0, next = 0; i < faces.size(); i = next) {
      while (next < faces.size() && faces[next].others == faces[i].others) ++next;
      if (next - i != 2 || faces[i].side * faces[i + 1].side >= 0) continue;
      const BorderFace &one = faces[i].face, &other = faces[i + 1].face;
      across[one.tet][one.corner] = other.tet;
      across[other.tet][other.corner] = one.tet;
    }
  }

  const DataMesh& mesh_;
  std::vector<std::uint64_t> first_;  // of each point in tets_, and one more
  std::vector<std::uint32_t> tets_;
};

}  // namespace

TetNeighbors find_neighbors(const DataMesh& mesh) {
  TetNeighbors found;
  constexpr std::uint32_t kNone = TetNeighbors::kNone;
  found.across.assign(mesh.tets.size(), {kNone, kNone, kNone, kNone});
  NeighborFinder(mesh).join_faces(found.across);
  for (std::size_t i = 0; i < found.across.size(); ++i) {
    for (std::uint32_t corner = 0; corner < 4; ++corner) {
      if (found.across[i][corner] != kNone) continue;
      found.border.push_back({static_cast<std::uint32_t>(i), corner});
    }
  }
  return found;
}

std::array<WorldPoint, 3> places_of(const DataMesh& mesh, const BorderFace& face) noexcept {
  const std::array<WorldPoint, 4> t = mesh.places(face.tet);
  return {t[(face.corner + 1) % 4], t[(face.corner + 2) % 4], t[(face.corner + 3) % 4]};
}

}  // namespace tet
