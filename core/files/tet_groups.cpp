#include "core/files/tet_groups.h"

#include <utility>

#include "core/mesh/regions.h"

namespace tet {

std::vector<TetGroup> tet_groups(const TetMesh& mesh) {
  const MeshHeader& header = mesh.header;
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
  if (!mesh.header.has_regions) return;
  inside_ = RankMask(mesh.header.tet_count);
  for (std::uint64_t tet = 0; tet < mesh.header.tet_count; ++tet) {
    if (mesh.region(tet) == MeshRegion::kInside) inside_.set(tet);
  }
  inside_.count_ranks();
}

}  // namespace tet
