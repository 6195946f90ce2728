#include "client/command/mesh/measure_labels.h"

#include <array>
#include <cstddef>
#include <numeric>

#include "core/base/tet_geometry.h"

namespace tet {
namespace {

/// Tets by their labels: a counting sort.
struct TetsByLabel {
  std::vector<std::uint64_t> first;  ///< of each label, and one more
  std::vector<std::uint64_t> tets;

  explicit TetsByLabel(const TetMesh& mesh)
      : first(mesh.header.labels.size() + 1), tets(mesh.header.tet_count) {
    for (std::uint64_t i = 0; i < tets.size(); ++i) ++first[mesh.label(i) + std::size_t{1}];
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<std::uint64_t> next(first.begin(), first.end() - 1);
    for (std::uint64_t i = 0; i < tets.size(); ++i) tets[next[mesh.label(i)]++] = i;
  }
};

/// Joins vertices, of one label at a time.
class JoinedVertices {
 public:
  explicit JoinedVertices(std::uint64_t vertices) : parent_(vertices), seen_(vertices) {}

  void next_label() noexcept { ++label_; }
  /// Counts a vertex that comes for the first time as a part of its own.
  void meet(std::uint64_t vertex, std::uint64_t& parts) noexcept {
    if (seen_[vertex] == label_) return;
    seen_[vertex] = label_;
    parent_[vertex] = vertex;
    ++parts;
  }
  void join(std::uint64_t a, std::uint64_t b, std::uint64_t& parts) noexcept {
    a = root(a);
    b = root(b);
    if (a == b) return;
    parent_[b] = a;
    --parts;
  }

 private:
  std::uint64_t root(std::uint64_t vertex) noexcept {
    while (parent_[vertex] != vertex) {
      parent_[vertex] = parent_[parent_[vertex]];
      vertex = parent_[vertex];
    }
    return vertex;
  }

  std::vector<std::uint64_t> parent_;
  std::vector<std::uint32_t> seen_;  // in which label
  std::uint32_t label_ = 0;
};

double six_volumes_of(const std::array<WorldPoint, 4>& corner) noexcept {
  const Vector ab = from_to(corner[0], corner[1]), ac = from_to(corner[0], corner[2]);
  return dot(cross(ab, ac), from_to(corner[0], corner[3]));
}

}  // namespace

std::vector<MeasuredLabel> measure_labels(const TetMesh& mesh) {
  std::vector<MeasuredLabel> labels(mesh.header.labels.size());
  if (labels.empty()) return labels;
  const MeshView view = mesh.view();
  for (std::uint64_t i = 0; i < mesh.header.tet_count; ++i) {
    MeasuredLabel& label = labels[mesh.label(i)];
    label.volume += six_volumes_of(view.stored_places(i)) / 6;
    ++label.tets;
  }
  return labels;
}

std::vector<std::uint64_t> count_label_parts(const TetMesh& mesh) {
  std::vector<std::uint64_t> parts(mesh.header.labels.size());
  if (parts.empty()) return parts;
  const TetsByLabel by_label(mesh);
  JoinedVertices vertices(mesh.header.vertex_count);
  for (std::size_t number = 0; number < parts.size(); ++number) {
    vertices.next_label();
    for (std::uint64_t i = by_label.first[number]; i < by_label.first[number + 1]; ++i) {
      const auto corner = mesh.tet(by_label.tets[i]);
      for (const std::uint64_t vertex : corner) vertices.meet(vertex, parts[number]);
      for (std::size_t k = 1; k < 4; ++k) vertices.join(corner[0], corner[k], parts[number]);
    }
  }
  return parts;
}

}  // namespace tet
