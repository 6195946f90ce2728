#include "core/mesh/find_faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "core/base/parallel.h"
#include "core/mesh/label_faces.h"
#include "core/mesh/tets_per_range.h"

namespace tet {
namespace {

constexpr std::size_t kBoxFaces = 6;
constexpr std::array kBoxFaceNames{"x_min", "x_max", "y_min", "y_max", "z_min", "z_max"};

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

  /// The first of the box's faces that a triangle is nearest to, of those on whose side it
  /// looks: a dent at an edge of the box is as near to one face as to the other, and is the
  /// one's that can be seen from within it.
  std::size_t nearest(const Triangle& triangle) const noexcept {
    const std::array corners{coordinates(triangle[0]), coordinates(triangle[1]),
                             coordinates(triangle[2])};
    const std::array<double, 3> outwards = normal_of(corners);
    std::array<std::pair<bool, double>, kBoxFaces> distance{};  // whether it looks elsewhere
    for (std::size_t face = 0; face < kBoxFaces; ++face) {
      const std::size_t axis = face / 2;
      auto& [elsewhere, sum] = distance[face];
      elsewhere = !(face % 2 == 0 ? outwards[axis] < 0 : outwards[axis] > 0);
      for (const Place& at : corners) sum += std::abs(at[axis] - place_[face]);
    }
    return static_cast<std::size_t>(std::ranges::min_element(distance) - distance.begin());
  }

 private:
  using Place = std::array<double, 3>;

  static Place normal_of(const std::array<Place, 3>& corners) noexcept {
    const auto& [a, b, c] = corners;
    const Place u{b[0] - a[0], b[1] - a[1], b[2] - a[2]},
        v{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  }

  Place coordinates(std::uint64_t i) const noexcept {
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

std::vector<TetFace> find_boundary_faces(const TetMesh& mesh,
                                         const Cancellation& cancellation) {
  return FaceSearch(mesh, cancellation).find();
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

FoundFaces find_faces(const TetMesh& mesh, const Cancellation& cancellation) {
  const MeshHeader& header = mesh.header;
  if (!header.labels.empty()) {
    return faces_between_labels(mesh, find_boundary_faces(mesh, cancellation), cancellation);
  }
  const bool in_box = header.has_regions || has_cut_faces(header);
  FoundFaces found{find_boundary_faces(mesh, cancellation),
                   face_labels_of(header.has_regions, in_box), labels_of(mesh)};
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
