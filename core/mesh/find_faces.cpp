#include "core/mesh/find_faces.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "core/base/mix_bits.h"
#include "core/base/parallel.h"
#include "core/mesh/label_faces.h"
#include "core/mesh/tets_per_range.h"

namespace tet {
namespace {

constexpr std::size_t kBoxFaces = 6;
constexpr std::size_t kVerticesPerRange = 65536;
constexpr std::array kBoxFaceNames{"x_min", "x_max", "y_min", "y_max", "z_min", "z_max"};

// ---- Which faces are there ----

/// A face whose vertices all have something that does not cancel around them.
struct Candidate {
  std::uint64_t low = 0, middle = 0, high = 0;  ///< vertices
  std::uint64_t index = 0;                      ///< see TetFace
};

/// What tets that belong together have in common: a label, or a region.
std::uint32_t group_of(const TetMesh& mesh, std::uint64_t tet) noexcept {
  return mesh.header.labels.empty() ? static_cast<std::uint32_t>(mesh.region(tet))
                                    : mesh.label(tet);
}

/// Faces look otherwise from each group, so that those between two do not cancel.
std::uint64_t salt_of(std::uint32_t group) noexcept {
  return mix_bits(group + std::uint64_t{1});
}

/// Tets that one task looks at for xor_seen_faces. They follow each other in space, mostly, and
/// so do vertices: the more there are, the fewer belong to another task.
constexpr std::uint64_t kTetsPerTask = std::uint64_t{1} << 19;

/// Where the vertices begin that belong to each task, and one more: about where those of its
/// tets begin. Any other choice gives the same sums.
std::vector<std::uint64_t> first_of_tasks(const TetMesh& mesh) {
  const std::uint64_t tasks = (mesh.header.tet_count + kTetsPerTask - 1) / kTetsPerTask;
  std::vector<std::uint64_t> first(tasks + 1);
  for (std::uint64_t task = 1; task < tasks; ++task) {
    auto tet = mesh.tet(task * kTetsPerTask);
    std::ranges::sort(tet);
    first[task] = std::max(first[task - 1], tet[1]);
  }
  first[tasks] = mesh.header.vertex_count;
  return first;
}

/// Calls `add(vertex, hashes)` for the corners of a tet, with the XOR of the hashes of the
/// three faces around each, as the tet sees them.
template <class Add>
void hash_faces(const TetMesh& mesh, std::uint64_t i, const Add& add) {
  const auto tet = mesh.tet(i);
  const std::uint64_t salt = salt_of(group_of(mesh, i));
  std::array<std::uint64_t, 4> corner;
  for (std::size_t k = 0; k < 4; ++k) corner[k] = mix_bits(tet[k]);
  const std::uint64_t sum = corner[0] + corner[1] + corner[2] + corner[3] + salt;
  std::array<std::uint64_t, 4> face;  // opposite each corner; whatever the order of its own
  for (std::size_t k = 0; k < 4; ++k) face[k] = mix_bits(sum - corner[k]);
  const std::uint64_t all = face[0] ^ face[1] ^ face[2] ^ face[3];
  for (std::size_t k = 0; k < 4; ++k) add(tet[k], all ^ face[k]);
}

/// For every vertex, the XOR of the hashes of the faces around it, as each tet sees them: what
/// two tets of one group share cancels. A vertex of the boundary, or between groups, is left
/// with zero by accident only, once in 2^64.
///
/// A task adds to its own vertices, and to those of others in a second column, which all share:
/// in whatever order, the sums are the same.
std::vector<std::uint64_t> xor_seen_faces(const TetMesh& mesh) {
  const std::vector<std::uint64_t> first = first_of_tasks(mesh);
  const std::size_t tasks = first.size() - 1;
  std::vector<std::uint64_t> seen(mesh.header.vertex_count);
  std::vector<std::uint64_t> shared(tasks > 1 ? seen.size() : 0);
  for_each_index(tasks, [&](std::size_t task) {
    const std::uint64_t begin = first[task], count = first[task + 1] - begin;
    const std::uint64_t end = std::min(mesh.header.tet_count, (task + 1) * kTetsPerTask);
    for (std::uint64_t i = task * kTetsPerTask; i < end; ++i) {
      hash_faces(mesh, i, [&](std::uint64_t vertex, std::uint64_t hashes) {
        if (vertex - begin < count) {
          seen[vertex] ^= hashes;
        } else {
          std::atomic_ref(shared[vertex]).fetch_xor(hashes, std::memory_order_relaxed);
        }
      });
    }
  });
  for_each_index(
      shared.size(), [&](std::size_t i) { seen[i] ^= shared[i]; }, kVerticesPerRange);
  return seen;
}

void add_candidates(const TetMesh& mesh,
                    std::span<const std::uint64_t> seen,
                    std::uint64_t i,
                    std::vector<Candidate>& candidates) {
  const auto tet = mesh.tet(i);
  std::array<bool, 4> open;
  for (std::size_t k = 0; k < 4; ++k) open[k] = seen[tet[k]] != 0;
  const auto count = std::count(open.begin(), open.end(), true);
  if (count < 3) return;
  for (std::size_t k = 0; k < 4; ++k) {
    if (count == 3 && open[k]) continue;
    const auto [low, middle, high] = sort_face(face_of(tet, k)).vertices;
    candidates.push_back({low, middle, high, 4 * i + k});
  }
}

/// In the order of their indices.
std::vector<Candidate> find_candidates(const TetMesh& mesh) {
  const std::vector<std::uint64_t> seen = xor_seen_faces(mesh);
  const std::uint64_t tets = mesh.header.tet_count;
  std::vector<std::vector<Candidate>> found((tets + kTetsPerRange - 1) / kTetsPerRange);
  for_each_index(found.size(), [&](std::size_t range) {
    const std::uint64_t end = std::min(tets, (range + 1) * std::uint64_t{kTetsPerRange});
    for (std::uint64_t i = range * std::uint64_t{kTetsPerRange}; i < end; ++i) {
      add_candidates(mesh, seen, i, found[range]);
    }
  });
  const auto first =
      offsets_from_counts(found.size(), [&](std::size_t i) { return found[i].size(); });
  std::vector<Candidate> all(first.back());
  for_each_index(found.size(), [&](std::size_t i) {
    std::ranges::copy(found[i], all.begin() + static_cast<std::ptrdiff_t>(first[i]));
    found[i] = {};
  });
  return all;
}

/// The candidates of each lowest vertex, by their places among all: a counting sort.
struct ByLowest {
  std::vector<std::uint64_t> first;  ///< of each vertex, and one more
  std::vector<std::uint64_t> place;

  ByLowest(std::span<const Candidate> candidates, std::uint64_t vertices)
      : first(vertices + 1), place(candidates.size()) {
    for (const Candidate& candidate : candidates) ++first[candidate.low + 1];
    for (std::uint64_t i = 0; i < vertices; ++i) first[i + 1] += first[i];
    std::vector<std::uint64_t> next(first.begin(), first.end() - 1);
    for (std::size_t i = 0; i < candidates.size(); ++i) place[next[candidates[i].low]++] = i;
  }
};

enum class FaceSide : std::uint8_t { kNone, kOuter, kInterface };

/// Sorts some candidates with one lowest vertex, and says which of them are faces.
void match(const TetMesh& mesh,
           std::span<const Candidate> candidates,
           std::span<std::uint64_t> places,
           std::span<FaceSide> sides,
           std::span<LabelNumber> behind) {
  const auto vertices = [&](std::uint64_t place) {
    return std::pair(candidates[place].middle, candidates[place].high);
  };
  std::ranges::sort(places, [&](std::uint64_t a, std::uint64_t b) {
    return std::pair(vertices(a), a) < std::pair(vertices(b), b);
  });
  for (std::size_t begin = 0, end = 0; begin < places.size(); begin = end) {
    while (end < places.size() && vertices(places[end]) == vertices(places[begin])) ++end;
    if (end - begin == 1) sides[places[begin]] = FaceSide::kOuter;
    if (end - begin != 2) continue;
    const auto group = [&](std::size_t i) {
      return group_of(mesh, candidates[places[i]].index / 4);
    };
    if (group(begin) == group(begin + 1)) continue;
    const bool second = group(begin + 1) < group(begin);
    const std::uint64_t place = places[second ? begin + 1 : begin];
    sides[place] = FaceSide::kInterface;
    behind[place] = static_cast<LabelNumber>(group(second ? begin : begin + 1));
  }
}

/// Faces, and the group that each has behind it; nothing behind one of the boundary.
struct GroupedFaces {
  std::vector<TetFace> faces;
  std::vector<LabelNumber> behind;
};

GroupedFaces find_grouped_faces(const TetMesh& mesh) {
  const std::vector<Candidate> candidates = find_candidates(mesh);
  ByLowest by_lowest(candidates, mesh.header.vertex_count);
  std::vector<FaceSide> sides(candidates.size(), FaceSide::kNone);
  std::vector<LabelNumber> behind(candidates.size(), kNoLabelBehind);
  for_each_index(
      mesh.header.vertex_count,
      [&](std::size_t vertex) {
        const std::uint64_t first = by_lowest.first[vertex];
        match(mesh, candidates,
              std::span(by_lowest.place).subspan(first, by_lowest.first[vertex + 1] - first),
              sides, behind);
      },
      kVerticesPerRange);
  const std::size_t count =
      candidates.size() - static_cast<std::size_t>(std::ranges::count(sides, FaceSide::kNone));
  GroupedFaces found;
  found.faces.reserve(count);
  found.behind.reserve(count);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (sides[i] == FaceSide::kNone) continue;
    found.faces.push_back({candidates[i].index, sides[i] == FaceSide::kInterface});
    found.behind.push_back(behind[i]);
  }
  return found;
}

// ---- Which labels they have ----

/// The faces of the box that each vertex lies in, as CutFaces.
class VertexCutFaces {
 public:
  explicit VertexCutFaces(const TetMesh& mesh)
      : row_bytes_(mesh.header.field_values() * sizeof(float)), mesh_(mesh) {}

  std::uint32_t operator[](std::uint64_t vertex) const noexcept {
    constexpr float kAllFaces = 63;
    float number = 0;
    std::memcpy(&number, &mesh_.fields.bytes()[(vertex + 1) * row_bytes_ - sizeof(float)],
                sizeof(number));
    // It came from a server: it may be anything.
    return number >= 0 && number <= kAllFaces ? static_cast<std::uint32_t>(number) : 0;
  }

 private:
  std::size_t row_bytes_;
  const TetMesh& mesh_;
};

/// The stored box around some vertices, as six places along the axes.
class OuterBox {
 public:
  explicit OuterBox(const TetMesh& mesh) : mesh_(mesh) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      place_[2 * axis] = std::numeric_limits<double>::infinity();
      place_[2 * axis + 1] = -place_[2 * axis];
    }
    for (std::uint64_t i = 0; i < mesh.header.vertex_count; ++i) {
      const std::array<double, 3> at = coordinates(i);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        place_[2 * axis] = std::min(place_[2 * axis], at[axis]);
        place_[2 * axis + 1] = std::max(place_[2 * axis + 1], at[axis]);
      }
    }
  }

  /// The first of the box's faces that a triangle is nearest to.
  std::size_t nearest(const Triangle& triangle) const noexcept {
    std::array<double, kBoxFaces> distance{};
    for (const std::uint64_t vertex : triangle) {
      const std::array<double, 3> at = coordinates(vertex);
      for (std::size_t face = 0; face < kBoxFaces; ++face) {
        distance[face] += std::abs(at[face / 2] - place_[face]);
      }
    }
    return static_cast<std::size_t>(std::ranges::min_element(distance) - distance.begin());
  }

 private:
  std::array<double, 3> coordinates(std::uint64_t i) const noexcept {
    const auto [x, y, z] = mesh_.stored_position(i);
    return {x, y, z};
  }

  const TetMesh& mesh_;
  std::array<double, kBoxFaces> place_;
};

/// Labels of one grid's mesh, whatever its part.
LabelFace labels_of(const TetMesh& mesh) {
  if (mesh.header.has_regions) {
    return [box = OuterBox(mesh)](const TetFace& face, const Triangle& triangle) {
      return face.is_interface ? std::uint16_t{0} : label_of_box_face(box.nearest(triangle));
    };
  }
  if (!has_cut_faces(mesh.header)) return [](auto&&...) { return std::uint16_t{0}; };
  return [faces = VertexCutFaces(mesh)](const TetFace&, const Triangle& triangle) {
    return label_of_cut(faces[triangle[0]] & faces[triangle[1]] & faces[triangle[2]]);
  };
}

template <class Number, std::size_t N>
void store_row(std::span<std::byte> column,
               std::size_t row,
               const std::array<std::uint64_t, N>& numbers) noexcept {
  std::array<Number, N> stored;
  std::ranges::transform(numbers, stored.begin(),
                         [](std::uint64_t n) { return static_cast<Number>(n); });
  std::memcpy(column.data() + row * sizeof(stored), stored.data(), sizeof(stored));
}

template <std::size_t N>
void store_as(IndexType type,
              std::span<std::byte> column,
              std::size_t row,
              const std::array<std::uint64_t, N>& numbers) noexcept {
  if (type == IndexType::kUint64) {
    store_row<std::uint64_t>(column, row, numbers);
  } else {
    store_row<std::uint32_t>(column, row, numbers);
  }
}

/// The label among those of the face's own part.
LabelFace label_in_part(const TetMesh& mesh, std::size_t labels_of_one, LabelFace of_one) {
  return [&mesh, labels_of_one, of_one = std::move(of_one)](const TetFace& face,
                                                            const Triangle& triangle) {
    const auto& parts = mesh.header.parts;
    const auto after = std::ranges::upper_bound(parts, face.tet(), {}, &MeshPart::first_tet);
    const auto part = static_cast<std::size_t>(after - parts.begin()) - 1;
    return static_cast<std::uint16_t>(part * labels_of_one + of_one(face, triangle));
  };
}

}  // namespace

bool has_cut_faces(const MeshHeader& header) noexcept {
  return !header.fields.empty() && header.fields.back().name == kCutFaceArray;
}

std::vector<TetFace> find_boundary_faces(const TetMesh& mesh) {
  return find_grouped_faces(mesh).faces;
}

std::vector<FaceLabel> face_labels_of(bool both_sides, bool in_box) {
  std::vector<FaceLabel> labels{
      both_sides ? FaceLabel{.name = "interface", .kind = FaceKind::kInterface}
                 : FaceLabel{.name = "surface", .kind = FaceKind::kSurface}};
  if (!in_box) return labels;
  for (const char* name : kBoxFaceNames) {
    labels.push_back(
        {.name = std::string(both_sides ? "box_" : "cut_") + name, .kind = FaceKind::kBox});
  }
  return labels;
}

void add_region_labels(std::span<const FaceRegion> regions, MeshHeader& header) {
  header.face_regions.assign(regions.begin(), regions.end());
  for (std::string& name : region_names(regions)) {
    header.face_labels.push_back({.name = std::move(name), .kind = FaceKind::kRegion});
  }
}

std::vector<FaceLabel> labels_of_parts(std::span<const FaceLabel> of_one,
                                       std::span<const MeshPart> parts) {
  std::vector<FaceLabel> labels;
  for (const MeshPart& part : parts) {
    for (FaceLabel label : of_one) {
      label.name = part.name + "_" + label.name;
      label.part = static_cast<std::uint32_t>(&part - parts.data()) + 1;
      labels.push_back(std::move(label));
    }
  }
  return labels;
}

FoundFaces find_faces(const TetMesh& mesh) {
  const MeshHeader& header = mesh.header;
  if (!header.labels.empty()) {
    GroupedFaces grouped = find_grouped_faces(mesh);
    return faces_between_labels(mesh, std::move(grouped.faces), grouped.behind);
  }
  const bool in_box = header.has_regions || has_cut_faces(header);
  FoundFaces found{find_boundary_faces(mesh), face_labels_of(header.has_regions, in_box),
                   labels_of(mesh)};
  if (!header.parts.empty()) {
    found.label = label_in_part(mesh, found.labels.size(), std::move(found.label));
    found.labels = labels_of_parts(found.labels, header.parts);
  }
  return found;
}

void set_faces(const FoundFaces& found, const TetMesh& mesh, TetMesh& to) {
  to.header.face_labels = found.labels;
  to.header.face_count = found.faces.size();
  const ChunkSizes sizes(to.header, 0, 0, found.faces.size());
  to.faces = ByteBuffer(sizes.faces);
  to.face_tets = ByteBuffer(sizes.face_tets);
  to.face_labels = ByteBuffer(sizes.face_labels);
  const auto store = [&](std::size_t i) {
    const TetFace& face = found.faces[i];
    const Triangle triangle = face_of(mesh.tet(face.tet()), face.opposite());
    store_as<3>(to.header.index_type, to.faces.bytes(), i, triangle);
    store_as<1>(to.header.index_type, to.face_tets.bytes(), i, {face.tet()});
    const std::uint16_t label = found.label(face, triangle);
    std::memcpy(to.face_labels.bytes().data() + i * sizeof(label), &label, sizeof(label));
  };
  for_each_index(found.faces.size(), store, kTetsPerRange);
}

}  // namespace tet
