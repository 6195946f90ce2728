#include "core/files/foam_faces.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace tet {
namespace {

/// The numbers of faces between two tets.
class InnerFaceNumbers {
 public:
  explicit InnerFaceNumbers(const TetNeighbours& behind)
      : behind_(behind), first_(behind.size() / 4 + 1) {
    for (std::uint64_t tet = 0; tet + 1 < first_.size(); ++tet) {
      first_[tet + 1] = first_[tet];
      for (std::size_t k = 0; k < 4; ++k) {
        const std::uint32_t other = behind[4 * tet + k];
        if (other != TetNeighbours::kNone && other > tet) ++first_[tet + 1];
      }
    }
  }

  /// Returns the number of the face between two tets.
  std::uint64_t number(std::uint64_t low, std::uint64_t high) const noexcept {
    std::uint64_t number = first_[low];
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint32_t other = behind_[4 * low + k];
      if (other > low && other < high) ++number;
    }
    return number;
  }

 private:
  const TetNeighbours& behind_;
  std::vector<std::uint64_t> first_;  ///< of each tet as the lower one
};

}  // namespace

FoamFaces::FoamFaces(const TetMesh& mesh, const Cancellation& cancellation)
    : behind_(mesh, cancellation) {
  const FaceGroups groups(mesh, cancellation);
  if (cancellation.requested()) return;
  sort_boundary(groups);
  find_zones(groups);
}

void FoamFaces::sort_boundary(const FaceGroups& groups) {
  RankMask named(behind_.size());  // a face is of one patch, whatever the mesh says
  const auto add_patch = [&](const std::string& name, std::uint64_t first) {
    if (boundary_.size() > first) patches_.push_back({name, first, boundary_.size() - first});
  };
  for (const FaceGroup& group : groups.groups()) {
    const std::uint64_t first = boundary_.size();
    for (std::uint64_t i = 0; i < group.faces; ++i) {
      const std::uint64_t face = groups[group.first + i].index;
      if (behind_[face] != TetNeighbours::kNone || named.has(face)) continue;
      named.set(face);
      boundary_.push_back(face);
    }
    add_patch(group.name, first);
  }
  const std::uint64_t first = boundary_.size();
  for (std::uint64_t face = 0; face < behind_.size(); ++face) {
    if (behind_[face] == TetNeighbours::kNone && !named.has(face)) boundary_.push_back(face);
  }
  add_patch("defaultFaces", first);
}

void FoamFaces::find_zones(const FaceGroups& groups) {
  std::optional<InnerFaceNumbers> numbers;  // few meshes have faces there that have a name
  for (const FaceGroup& group : groups.groups()) {
    std::vector<FoamZone::Face> faces;
    for (std::uint64_t i = 0; i < group.faces; ++i) {
      const std::uint64_t face = groups[group.first + i].index;
      const std::uint64_t tet = face / 4, other = behind_[face];
      if (other == TetNeighbours::kNone) continue;
      if (!numbers) numbers.emplace(behind_);
      faces.push_back(
          {numbers->number(std::min(tet, other), std::max(tet, other)), tet > other});
    }
    if (faces.empty()) continue;
    std::ranges::sort(faces);
    const auto same = [](const FoamZone::Face& a, const FoamZone::Face& b) {
      return a.number == b.number;
    };
    faces.erase(std::unique(faces.begin(), faces.end(), same), faces.end());
    zones_.push_back({group.name, std::move(faces)});
  }
}

}  // namespace tet
