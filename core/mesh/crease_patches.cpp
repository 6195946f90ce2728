#include "core/mesh/crease_patches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>

#include "core/base/loop_in_order.h"
#include "core/base/parallel.h"
#include "core/base/rank_mask.h"
#include "core/base/union_find.h"
#include "core/base/vec3.h"
#include "core/scene/waves.h"

namespace tet {
namespace {

using FaceNumber = std::uint32_t;  ///< among the faces of one label
constexpr FaceNumber kNoFace = CreasePatches::kNone;
constexpr std::size_t kFacesPerRange = 1024;

template <class Body>
void for_faces(std::uint64_t count, const Cancellation& cancellation, const Body& body) {
  for_each_in_order(count, cancellation,
                    [&](std::uint64_t i) { body(static_cast<FaceNumber>(i)); });
}

/// Does the same in parallel.
template <class Body>
void for_faces_in_parallel(std::size_t count,
                           const Cancellation& cancellation,
                           const Body& body) {
  for_each_range(count, kFacesPerRange, [&](std::size_t begin, std::size_t end) {
    if (cancellation.requested()) return;
    for (std::size_t i = begin; i < end; ++i) body(static_cast<FaceNumber>(i));
  });
}

std::vector<std::uint64_t> faces_of_label(const TetMesh& surface,
                                          std::uint16_t label,
                                          const Cancellation& cancellation) {
  constexpr std::uint64_t kBetweenLooks = 1 << 16;
  std::vector<std::uint64_t> faces;
  for (std::uint64_t i = 0; i < surface.header.face_count; ++i) {
    if (i % kBetweenLooks == 0 && cancellation.requested()) break;
    if (surface.face_label(i) == label) faces.push_back(i);
  }
  return faces;
}

/// The vertices of some faces: they are numbered one after the other.
RankMask vertices_of(const TetMesh& surface,
                     std::span<const std::uint64_t> faces,
                     const Cancellation& cancellation) {
  RankMask vertices(surface.header.vertex_count);
  for_faces(faces.size(), cancellation, [&](FaceNumber i) {
    for (const std::uint64_t vertex : surface.face(faces[i])) vertices.set(vertex);
  });
  vertices.count_ranks();
  return vertices;
}

/// One long, or 0 of a face without an area.
BasicVector<float> direction_of(const TetMesh& surface, const Triangle& triangle) noexcept {
  std::array<Vector, 3> p;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto [x, y, z] = surface.stored_position(triangle[k]);
    p[k] = {x, y, z};
  }
  const Vector normal = cross(p[1] - p[0], p[2] - p[0]);
  const double length = std::sqrt(dot(normal, normal));
  if (!(length > 0)) return {0, 0, 0};
  return {static_cast<float>(normal.x / length), static_cast<float>(normal.y / length),
          static_cast<float>(normal.z / length)};
}

/// Faces with one label, and what lies around each.
class FaceRings {
 public:
  FaceRings(const TetMesh& surface,
            std::span<const std::uint64_t> faces,
            const Cancellation& cancellation);

  FaceNumber size() const noexcept { return static_cast<FaceNumber>(direction_.size()); }
  /// Across each edge: kNoFace where there is none, or more than one.
  const std::array<FaceNumber, 3>& beside(FaceNumber face) const noexcept {
    return beside_[face];
  }
  /// The cosine of the angle between the directions of two faces.
  float likeness(FaceNumber a, FaceNumber b) const noexcept {
    return dot(direction_[a], direction_[b]);
  }
  /// How many rings of faces around one, up to two, are as like it as that.
  std::uint8_t calm_rings(FaceNumber face, float least_likeness) const noexcept;

 private:
  using Corners = std::array<std::uint32_t, 3>;

  std::span<const FaceNumber> around(std::uint32_t vertex) const noexcept {
    return std::span(at_).subspan(first_at_[vertex], first_at_[vertex + 1] - first_at_[vertex]);
  }
  FaceNumber find_beside(FaceNumber face, std::size_t side) const noexcept;
  void sort_by_vertex(std::uint64_t vertices, const Cancellation& cancellation);

  std::vector<Corners> corners_;
  std::vector<BasicVector<float>> direction_;
  std::vector<std::array<FaceNumber, 3>> beside_;
  std::vector<std::uint64_t> first_at_;  // of each vertex, and one more
  std::vector<FaceNumber> at_;
};

FaceRings::FaceRings(const TetMesh& surface,
                     std::span<const std::uint64_t> faces,
                     const Cancellation& cancellation)
    : corners_(faces.size()), direction_(faces.size()), beside_(faces.size()) {
  const RankMask vertices = vertices_of(surface, faces, cancellation);
  for_faces_in_parallel(faces.size(), cancellation, [&](FaceNumber i) {
    const Triangle triangle = surface.face(faces[i]);
    direction_[i] = direction_of(surface, triangle);
    for (std::size_t k = 0; k < 3; ++k) {
      corners_[i][k] = static_cast<std::uint32_t>(vertices.rank(triangle[k]));
    }
  });
  if (cancellation.requested()) return;  // vertices are missing
  sort_by_vertex(vertices.count(), cancellation);
  for_faces_in_parallel(faces.size(), cancellation, [&](FaceNumber i) {
    for (std::size_t side = 0; side < 3; ++side) beside_[i][side] = find_beside(i, side);
  });
}

/// A counting sort.
void FaceRings::sort_by_vertex(std::uint64_t vertices, const Cancellation& cancellation) {
  first_at_.resize(vertices + 1);
  for_faces(size(), cancellation, [&](FaceNumber i) {
    for (const std::uint32_t vertex : corners_[i]) ++first_at_[vertex + 1];
  });
  for (std::size_t i = 1; i < first_at_.size(); ++i) first_at_[i] += first_at_[i - 1];
  at_.resize(first_at_.back());
  std::vector<std::uint64_t> next(first_at_.begin(), first_at_.end() - 1);
  if (cancellation.requested()) return;  // there may be too little room
  for_faces(size(), cancellation, [&](FaceNumber i) {
    for (const std::uint32_t vertex : corners_[i]) at_[next[vertex]++] = i;
  });
}

FaceNumber FaceRings::find_beside(FaceNumber face, std::size_t side) const noexcept {
  const std::uint32_t to = corners_[face][(side + 1) % 3];
  FaceNumber found = kNoFace;
  for (const FaceNumber other : around(corners_[face][side])) {
    if (other == face || std::ranges::find(corners_[other], to) == corners_[other].end()) {
      continue;
    }
    if (found != kNoFace) return kNoFace;
    found = other;
  }
  return found;
}

std::uint8_t FaceRings::calm_rings(FaceNumber face, float least_likeness) const noexcept {
  const auto is_calm_at = [&](std::uint32_t vertex) {
    return std::ranges::all_of(around(vertex), [&](FaceNumber other) {
      return likeness(face, other) >= least_likeness;
    });
  };
  const Corners& own = corners_[face];
  if (!std::ranges::all_of(own, is_calm_at)) return 0;
  for (const std::uint32_t vertex : own) {
    for (const FaceNumber other : around(vertex)) {
      const bool is_calm = std::ranges::all_of(corners_[other], [&](std::uint32_t beyond) {
        return std::ranges::find(own, beyond) != own.end() || is_calm_at(beyond);
      });
      if (!is_calm) return 1;
    }
  }
  return 2;
}

/// Finds patches; until they are numbered, each is known by one of its faces.
class PatchFinder {
 public:
  PatchFinder(const FaceRings& faces, float least_likeness, const Cancellation& cancellation)
      : faces_(faces),
        least_likeness_(least_likeness),
        cancellation_(cancellation),
        calm_(faces.size()),
        patch_(faces.size(), kNoFace) {
    for_faces_in_parallel(calm_.size(), cancellation, [&](FaceNumber i) {
      calm_[i] = faces.calm_rings(i, least_likeness);
    });
  }

  /// Faces that are calm within so many rings, and in no patch, are patches where they lie
  /// beside each other.
  void begin_patches(std::uint8_t rings);
  /// Patches grow over the faces beside them, a ring at a time: over those that `may_take` lets
  /// them have, a face and one beside it that is in the patch.
  template <class MayTake>
  void grow(int rings, const MayTake& may_take);

  void grow_over_calm() {
    constexpr int kSteps = 4;  // from edge to edge across a ring around vertices
    grow(kSteps, [&](FaceNumber face, FaceNumber from) {
      return calm_[face] > 0 && faces_.likeness(face, from) >= least_likeness_;
    });
  }
  /// Patches are one where nine tenths of the border between them are as smooth as that.
  void join(float least_likeness);
  void grow_over_all() {
    grow(std::numeric_limits<int>::max(), [](FaceNumber, FaceNumber) { return true; });
  }

  /// Numbers them; how many there are.
  std::uint32_t number(std::vector<std::uint32_t>& patch) const;

 private:
  template <class Body>
  void for_all_faces(const Body& body) const {
    for_faces(faces_.size(), cancellation_, body);
  }

  const FaceRings& faces_;
  const float least_likeness_;
  const Cancellation& cancellation_;
  std::vector<std::uint8_t> calm_;  // rings
  std::vector<FaceNumber> patch_;
};

void PatchFinder::begin_patches(std::uint8_t rings) {
  constexpr FaceNumber kLeastFaces = 8;  // fewer are the bits between other patches
  const auto may_begin = [&](FaceNumber face) {
    return patch_[face] == kNoFace && calm_[face] >= rings;
  };
  UnionFind beside(patch_.size());
  for_all_faces([&](FaceNumber i) {
    if (!may_begin(i)) return;
    for (const FaceNumber other : faces_.beside(i)) {
      if (other != kNoFace && other < i && may_begin(other)) beside.unite(i, other);
    }
  });
  std::vector<FaceNumber> first(patch_.size(), kNoFace), size(patch_.size());
  for_all_faces([&](FaceNumber i) {
    if (!may_begin(i)) return;
    first[i] = static_cast<FaceNumber>(beside.find(i));
    ++size[first[i]];
  });
  for_all_faces([&](FaceNumber i) {
    if (first[i] != kNoFace && size[first[i]] >= kLeastFaces) patch_[i] = first[i];
  });
}

template <class MayTake>
void PatchFinder::grow(int rings, const MayTake& may_take) {
  // Only beside what the ring before took can a face be taken that was not then: so all rings
  // together look at a face a few times, however many they are.
  std::vector<FaceNumber> candidates;
  for_all_faces([&](FaceNumber i) {
    if (patch_[i] == kNoFace) candidates.push_back(i);
  });
  std::vector<std::pair<FaceNumber, FaceNumber>> taken;  // a face and its patch
  for (int ring = 0; ring < rings; ++ring) {
    taken.clear();
    for_faces(candidates.size(), cancellation_, [&](FaceNumber at) {
      const FaceNumber i = candidates[at];
      if (patch_[i] != kNoFace) return;
      float most = -std::numeric_limits<float>::infinity();
      FaceNumber best = kNoFace;
      for (const FaceNumber other : faces_.beside(i)) {
        if (other == kNoFace || patch_[other] == kNoFace || !may_take(i, other)) continue;
        const float likeness = faces_.likeness(i, other);
        if (likeness < most || (likeness == most && patch_[other] > best)) continue;
        most = likeness;
        best = patch_[other];
      }
      if (best != kNoFace) taken.emplace_back(i, best);
    });
    if (taken.empty() || cancellation_.requested()) return;
    candidates.clear();
    for (const auto& [face, patch] : taken) {
      if (patch_[face] != kNoFace) continue;  // it lies beside two that were taken
      patch_[face] = patch;
      for (const FaceNumber other : faces_.beside(face)) {
        if (other != kNoFace && patch_[other] == kNoFace) candidates.push_back(other);
      }
    }
  }
}

void PatchFinder::join(float least_likeness) {
  constexpr std::size_t kLeastEdges = 2;
  struct BorderEdge {
    FaceNumber one = 0, other = 0;  ///< patches
    bool is_smooth = false;
    auto patches() const noexcept { return std::pair(one, other); }
  };
  std::vector<BorderEdge> border;
  for_all_faces([&](FaceNumber i) {
    for (const FaceNumber k : faces_.beside(i)) {
      if (k == kNoFace || k < i || patch_[i] == patch_[k]) continue;
      if (patch_[i] == kNoFace || patch_[k] == kNoFace) continue;
      const auto [one, other] = std::minmax(patch_[i], patch_[k]);
      border.push_back({one, other, faces_.likeness(i, k) >= least_likeness});
    }
  });
  std::ranges::sort(border, {}, &BorderEdge::patches);
  UnionFind joined(patch_.size());
  for (std::size_t begin = 0, end = 0; begin < border.size(); begin = end) {
    std::size_t smooth = 0;
    while (end < border.size() && border[end].patches() == border[begin].patches()) {
      smooth += border[end++].is_smooth ? 1 : 0;
    }
    if (smooth >= kLeastEdges && 10 * smooth >= 9 * (end - begin)) {
      joined.unite(border[begin].one, border[begin].other);
    }
  }
  for_all_faces([&](FaceNumber i) {
    if (patch_[i] != kNoFace) patch_[i] = static_cast<FaceNumber>(joined.find(patch_[i]));
  });
}

std::uint32_t PatchFinder::number(std::vector<std::uint32_t>& patch) const {
  std::vector<FaceNumber> size(patch_.size()), lowest(patch_.size(), kNoFace), patches;
  for_all_faces([&](FaceNumber i) {
    const FaceNumber of = patch_[i];
    if (of == kNoFace || size[of]++ > 0) return;
    lowest[of] = i;
    patches.push_back(of);
  });
  std::ranges::sort(patches, [&](FaceNumber a, FaceNumber b) {
    return std::pair(size[b], lowest[a]) < std::pair(size[a], lowest[b]);
  });
  std::vector<std::uint32_t>& number_of = size;
  for (std::uint32_t i = 0; i < patches.size(); ++i) number_of[patches[i]] = i;
  patch.resize(patch_.size());
  std::ranges::transform(patch_, patch.begin(), [&](FaceNumber of) {
    return of == kNoFace ? CreasePatches::kNone : number_of[of];
  });
  return static_cast<std::uint32_t>(patches.size());
}

}  // namespace

CreasePatches find_crease_patches(const TetMesh& surface,
                                  std::uint16_t label,
                                  double angle_deg,
                                  const Cancellation& cancellation) {
  CreasePatches found{.faces = faces_of_label(surface, label, cancellation)};
  const FaceRings faces(surface, found.faces, cancellation);
  // Directions are floats: flat faces must be alike at any angle.
  constexpr double kRounding = 1e-6;
  const auto likeness_at = [&](double degrees) {
    return static_cast<float>(scene::cos_of_turns(degrees / 360) - kRounding);
  };
  constexpr double kSmoothPart = 0.25;  // bevels turn by more from triangle to triangle
  PatchFinder finder(faces, likeness_at(angle_deg), cancellation);
  finder.begin_patches(2);
  finder.grow_over_calm();
  finder.begin_patches(1);
  finder.grow_over_all();
  finder.join(likeness_at(kSmoothPart * angle_deg));
  found.count = finder.number(found.patch);
  return found;
}

}  // namespace tet
