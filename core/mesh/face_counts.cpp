#include "core/mesh/face_counts.h"

#include <algorithm>
#include <cstddef>

namespace tet {

std::string name_in_request(const FaceLabel& label, const MeshHeader& header) {
  if (label.part == 0 || label.part > header.parts.size()) return label.name;
  const std::size_t grid = header.parts[label.part - 1].name.size() + 1;
  return label.name.substr(std::min(grid, label.name.size()));
}

std::vector<std::uint64_t> count_faces(const TetMesh& mesh) {
  std::vector<std::uint64_t> counts(mesh.header.face_labels.size());
  for (std::uint64_t i = 0; i < mesh.header.face_count; ++i) ++counts[mesh.face_label(i)];
  return counts;
}

std::vector<std::string> empty_face_regions(const MeshHeader& header,
                                            const std::vector<std::uint64_t>& counts) {
  std::vector<std::string> empty, taken;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (header.face_labels[i].kind != FaceKind::kRegion) continue;
    std::vector<std::string>& names = counts[i] == 0 ? empty : taken;
    std::string name = name_in_request(header.face_labels[i], header);
    if (std::ranges::find(names, name) == names.end()) names.push_back(std::move(name));
  }
  std::erase_if(empty, [&](const std::string& name) {
    return std::ranges::find(taken, name) != taken.end();
  });
  return empty;
}

}  // namespace tet
