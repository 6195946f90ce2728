#include "core/files/tet_groups.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "core/mesh/label_faces.h"
#include "core/mesh/regions.h"

namespace tet {
namespace {

/// Where the tets of each label begin among all, sorted by label; and one more.
std::vector<std::uint64_t> first_of_labels(const TetMesh& mesh) {
  std::vector<std::uint64_t> first(mesh.header.labels.size() + 1);
  for (std::uint64_t i = 0; i < mesh.header.tet_count; ++i) {
    ++first[mesh.label(i) + std::size_t{1}];
  }
  std::partial_sum(first.begin(), first.end(), first.begin());
  return first;
}

/// Calls `visit(place, tet)` for each tet; places are those once they are sorted by label.
template <class Visit>
void for_each_by_label(const TetMesh& mesh,
                       std::vector<std::uint64_t> next,
                       const Visit& visit) {
  for (std::uint64_t i = 0; i < mesh.header.tet_count; ++i) visit(next[mesh.label(i)]++, i);
}

std::vector<TetGroup> label_groups(const TetMesh& mesh) {
  const std::vector<std::uint64_t> first = first_of_labels(mesh);
  auto order = std::make_shared<std::vector<std::uint64_t>>(mesh.header.tet_count);
  for_each_by_label(mesh, first,
                    [&](std::uint64_t place, std::uint64_t tet) { (*order)[place] = tet; });
  const std::vector<std::string> names = distinct_names(mesh.header.labels);
  const std::vector<std::int32_t> tags = tags_of_labels(mesh.header);
  std::vector<TetGroup> groups;
  for (std::size_t i = 0; i < names.size(); ++i) {
    groups.push_back({tags[i], names[i], {}, first[i], first[i + 1] - first[i], order});
  }
  return groups;
}

}  // namespace

std::vector<std::int32_t> tags_of_labels(const MeshHeader& header) {
  const bool are_tags = std::ranges::all_of(header.labels, [](const MeshLabel& label) {
    return label.value >= 1 && label.value <= std::numeric_limits<std::int32_t>::max();
  });
  std::vector<std::int32_t> tags;
  for (const MeshLabel& label : header.labels) {
    tags.push_back(are_tags ? static_cast<std::int32_t>(label.value)
                            : static_cast<std::int32_t>(tags.size() + 1));
  }
  return tags;
}

std::vector<TetGroup> tet_groups(const TetMesh& mesh) {
  const MeshHeader& header = mesh.header;
  if (!header.labels.empty()) return label_groups(mesh);
  std::vector<TetGroup> groups;
  for (const MeshPart& part : header.parts) {
    const auto tag = static_cast<std::int32_t>(groups.size() + 1);
    groups.push_back({tag, part.name, {}, part.first_tet, part.tet_count});
  }
  if (!groups.empty()) return groups;
  if (!header.has_regions) {
    return {TetGroup{.name = "inside", .tets = header.tet_count}};
  }
  for (const auto& [region, name] :
       {std::pair(MeshRegion::kInside, "inside"), std::pair(MeshRegion::kOutside, "outside")}) {
    groups.push_back(
        {static_cast<std::int32_t>(region), name, region, 0, count_tets(mesh, region)});
  }
  return groups;
}

GroupedOrder::GroupedOrder(const TetMesh& mesh) {
  if (!mesh.header.labels.empty()) {
    place_.resize(mesh.header.tet_count);
    for_each_by_label(mesh, first_of_labels(mesh),
                      [&](std::uint64_t place, std::uint64_t tet) { place_[tet] = place; });
  }
  if (!mesh.header.has_regions) return;
  inside_ = RankMask(mesh.header.tet_count);
  for (std::uint64_t tet = 0; tet < mesh.header.tet_count; ++tet) {
    if (mesh.region(tet) == MeshRegion::kInside) inside_.set(tet);
  }
  inside_.count_ranks();
}

}  // namespace tet
