#include "core/mesh/improve/vertex_stars.h"

#include <algorithm>
#include <array>

#include "core/base/parallel.h"
#include "core/mesh/tets_per_range.h"

namespace tet {
namespace {

/// A corner at a chosen vertex.
struct ChosenCorner {
  std::uint32_t vertex = 0;
  TetCorner corner;
};

}  // namespace

VertexStars::VertexStars(const TetMesh& mesh) : number_(mesh.header.vertex_count, kNotChosen) {}

VertexStars::VertexStars(const TetMesh& mesh, std::span<const std::uint64_t> tets)
    : VertexStars(mesh) {
  for (const std::uint64_t tet : tets) {
    for (const std::uint64_t vertex : mesh.tet(tet)) number_[vertex] = 0;
  }
  number_chosen();
  gather(mesh);
}

VertexStars VertexStars::around(const TetMesh& mesh, std::span<const std::uint64_t> vertices) {
  VertexStars stars(mesh);
  for (const std::uint64_t vertex : vertices) stars.number_[vertex] = 0;
  stars.number_chosen();
  stars.gather(mesh);
  return stars;
}

void VertexStars::number_chosen() {
  for (std::uint64_t vertex = 0; vertex < number_.size(); ++vertex) {
    if (number_[vertex] == kNotChosen) continue;
    number_[vertex] = static_cast<std::uint32_t>(vertex_.size());
    vertex_.push_back(vertex);
  }
}

void VertexStars::gather(const TetMesh& mesh) {
  const std::uint64_t tets = mesh.header.tet_count;
  std::vector<std::vector<ChosenCorner>> ranges((tets + kTetsPerRange - 1) / kTetsPerRange);
  for_each_index(ranges.size(), [&](std::size_t r) {
    const std::uint64_t end = std::min(tets, (r + 1) * kTetsPerRange);
    for (std::uint64_t i = r * kTetsPerRange; i < end; ++i) {
      const auto tet = mesh.tet(i);
      for (std::size_t k = 0; k < 4; ++k) {
        const std::uint32_t vertex = number_[tet[k]];
        if (vertex != kNotChosen) ranges[r].push_back({vertex, {4 * i + k}});
      }
    }
  });

  std::vector<std::uint32_t> count(size());
  for (const auto& range : ranges) {
    for (const ChosenCorner& found : range) ++count[found.vertex];
  }
  first_ = offsets_from_counts(size(), [&](std::size_t i) { return count[i]; });
  corners_.resize(first_.back());
  std::vector<std::uint64_t> next(first_.begin(), first_.end() - 1);
  for (const auto& range : ranges) {
    for (const ChosenCorner& found : range) corners_[next[found.vertex]++] = found.corner;
  }
}

std::vector<std::vector<std::uint32_t>> independent_sets(const TetMesh& mesh,
                                                         const VertexStars& stars) {
  // One vertex after another takes the first set without a neighbour.
  constexpr std::uint32_t kNone = ~std::uint32_t{0};
  std::vector<std::uint32_t> set_of(stars.size(), kNone);
  std::vector<std::vector<std::uint32_t>> sets;
  std::vector<std::uint32_t> last_neighbour;  // of each set: the vertex that has one there
  for (std::uint32_t i = 0; i < stars.size(); ++i) {
    for (const TetCorner corner : stars.star(i)) {
      for (const std::uint64_t vertex : mesh.tet(corner.tet())) {
        const std::uint32_t other = stars.number(vertex);
        if (other < i) last_neighbour[set_of[other]] = i;
      }
    }
    const auto free = std::find_if(last_neighbour.begin(), last_neighbour.end(),
                                   [&](std::uint32_t v) { return v != i; });
    set_of[i] = static_cast<std::uint32_t>(free - last_neighbour.begin());
    if (free == last_neighbour.end()) {
      last_neighbour.push_back(kNone);
      sets.emplace_back();
    }
    sets[set_of[i]].push_back(i);
  }
  return sets;
}

}  // namespace tet
