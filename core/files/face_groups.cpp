#include "core/files/face_groups.h"

#include <algorithm>
#include <span>

namespace tet {
namespace {

/// Faces with their labels, whoever has them.
struct LabelledFaces {
  std::vector<FaceLabel> labels;
  std::vector<std::uint64_t> faces;  ///< see TetFace::index
  std::vector<std::uint16_t> label;  ///< of each
};

LabelledFaces faces_of_columns(const TetMesh& mesh) {
  LabelledFaces all{mesh.header.face_labels, {}, {}};
  all.faces.reserve(mesh.header.face_count);
  all.label.reserve(mesh.header.face_count);
  for (std::uint64_t i = 0; i < mesh.header.face_count; ++i) {
    // What a server sent is a triangle of the tet: that was checked when it came.
    const std::uint64_t tet = mesh.face_tet(i);
    all.faces.push_back(4 * tet + opposite_corner(mesh.tet(tet), mesh.face(i)));
    all.label.push_back(mesh.face_label(i));
  }
  return all;
}

LabelledFaces faces_found_in(const TetMesh& mesh, const Cancellation& cancellation) {
  FoundFaces found = find_faces(mesh, cancellation);
  if (cancellation.requested()) return {};
  LabelledFaces all{std::move(found.labels), {}, {}};
  all.faces.reserve(found.faces.size());
  all.label.reserve(found.faces.size());
  for (const TetFace& face : found.faces) {
    all.faces.push_back(face.index);
    all.label.push_back(found.label(face, face_of(mesh.tet(face.tet()), face.opposite())));
  }
  return all;
}

}  // namespace

FaceGroups::FaceGroups(const TetMesh& mesh, const Cancellation& cancellation) : mesh_(mesh) {
  const LabelledFaces all =
      mesh.header.has_faces() ? faces_of_columns(mesh) : faces_found_in(mesh, cancellation);
  std::vector<std::uint64_t> next(all.labels.size() + 1);
  for (const std::uint16_t label : all.label) ++next[label + 1U];
  for (std::size_t i = 0; i < all.labels.size(); ++i) {
    const std::uint64_t faces = next[i + 1];
    next[i + 1] += next[i];
    if (faces == 0) continue;
    groups_.push_back({static_cast<std::int32_t>(i + 1), all.labels[i].name, all.labels[i].kind,
                       next[i], faces});
  }
  faces_.resize(all.faces.size());
  for (std::size_t i = 0; i < all.faces.size(); ++i) {
    faces_[next[all.label[i]]++] = all.faces[i];
  }
}

void FaceGroups::collect_nodes(const FileMesh& mesh,
                               const FaceGroup& group,
                               RankMask& nodes) const {
  nodes.clear();
  with_nodes_per_tet(mesh, [&](auto count) {
    for (std::uint64_t i = group.first; i < group.first + group.faces; ++i) {
      const TetFace face = (*this)[i];
      const auto of_tet = mesh.nodes_of<decltype(count)::value>(face.tet());
      for (const auto node : nodes_of_face(of_tet, face.opposite())) nodes.set(node);
    }
  });
  nodes.count_ranks();
}

}  // namespace tet
