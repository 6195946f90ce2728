#include "core/vdb/plain/plain_grid.h"

#include <utility>

#include <absl/status/status.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/base/posix/byte_source.h"
#include "core/vdb/plain/conversion_report.h"
#include "core/vdb/plain/grid_facts.h"
#include "core/vdb/plain/plain_tree.h"
#include "core/vdb/walk/walk_refusal.h"
#include "core/vdb/walk/walk_vdb.h"
#include "core/volume/check_transform.h"

namespace tet {
namespace {

ByteSource bytes_of(const OpenGridFile& file) {
  return ByteSource(file.descriptor, static_cast<std::uint64_t>(file.size_bytes));
}

/// What the map does to points, in the order in which OpenVDB rounds.
absl::StatusOr<VoxelTransform> transform_of(const AxisMap& map) {
  const auto scaled = [&](double x, std::size_t i) {
    return map.scales ? x * map.scale[i] : x;
  };
  VoxelTransform transform;
  for (std::size_t i = 0; i < 3; ++i) {
    const double origin = scaled(0, i);
    transform.translation[i] = map.moves ? origin + map.translation[i] : origin;
    for (std::size_t j = 0; j < 3; ++j) transform.linear[i][j] = scaled(i == j ? 1 : 0, i);
  }
  transform.voxel_size = voxel_edge(transform);
  if (absl::Status s = check_transform(transform); !s.ok()) return s;
  return transform;
}

absl::StatusOr<Volume> read_grid(const OpenGridFile& file,
                                 const GridOutline& grid,
                                 GridUse use) {
  absl::StatusOr<VoxelTransform> transform = transform_of(*grid.map);
  if (!transform.ok()) return transform.status();
  Volume volume;
  volume.name = grid.name;
  volume.kind = use == GridUse::kField ? VolumeKind::kField : VolumeKind::kLevelSet;
  volume.transform = *transform;
  auto constants = read_plain_tree(bytes_of(file), grid, volume);
  if (!constants.ok()) return constants.status();
  absl::StatusOr<Volume> made = finish_volume(std::move(volume), *std::move(constants));
  if (made.ok() && use == GridUse::kSurface) set_kind(grid_class_of(grid.grid_class), *made);
  return made;
}

absl::Status told(const std::string& what, const absl::Status& error) {
  return {error.code(), absl::StrCat(what, ": ", error.message())};
}

absl::Status told_of_refusal(const OpenGridFile& file, const WalkRefusal& refusal) {
  return told(absl::StrFormat("'%s' is not a readable VDB file", file.name), refusal.status());
}

GridInfo describe(const ByteSource& source, const GridOutline& grid) {
  GridInfo info;
  info.name = grid.name;
  info.value_type = grid.tree_type == "Tree_double_5_4_3" ? "double" : "float";
  info.grid_class = grid_class_of(grid.grid_class);
  info.voxel_size = grid.map->voxel_size[0];
  const absl::StatusOr<VoxelTransform> transform = transform_of(*grid.map);
  if (transform.ok()) {
    info.voxel_size = transform->voxel_size;
    info.place = describe_voxels(*transform);
    info.field_components = 1;
  }
  info.active_voxels = grid.tree.active_voxels;
  info.active_box = grid.tree.active_box;
  const PlainRoot root = read_plain_root(source, grid);
  info.background = root.background;
  info.not_meshable = std::string(transform.status().message());
  if (info.not_meshable.empty() && root.empty) info.not_meshable = "it is empty";
  VdbCursor metadata(source);
  metadata.move_to(grid.metadata_at);
  info.made_of = surface_text(read_texts(metadata, kSurfaceMetadata, MetadataLimits()));
  return info;
}

}  // namespace

absl::StatusOr<Volume> read_plain_grid(const OpenGridFile& file,
                                       const VdbOutline& outline,
                                       std::size_t grid,
                                       GridUse use) {
  const GridOutline& outlined = outline.grids[grid];
  try {
    absl::StatusOr<Volume> volume = read_grid(file, outlined, use);
    if (volume.ok()) return volume;
    return told(absl::StrFormat("grid '%s' of '%s'", outlined.name, file.name),
                volume.status());
  } catch (const WalkRefusal& refusal) {
    return told_of_refusal(file, refusal);
  }
}

absl::StatusOr<std::vector<GridInfo>> list_plain_grids(const OpenGridFile& file,
                                                       const VdbOutline& outline) {
  const ByteSource source = bytes_of(file);
  std::vector<GridInfo> grids;
  try {
    for (const GridOutline& grid : outline.grids) grids.push_back(describe(source, grid));
    return grids;
  } catch (const WalkRefusal& refusal) {
    return told_of_refusal(file, refusal);
  }
}

}  // namespace tet
