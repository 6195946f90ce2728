// What a .vdb file holds, as told by its bytes alone: read before anything is built of them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/types.h"

namespace tet {

/// How a grid's value arrays are stored; OpenVDB's flags, bit by bit.
struct VdbCompression {
  bool zip = false;
  bool active_mask = false;  ///< inactive values are left out where at most two differ
  bool blosc = false;        ///< goes before `zip` where both are set
};

/// Tiles of one level: constant cubes of 4096 (root), 128 (upper) or 8 (lower) voxels.
struct TileCounts {
  std::uint64_t active = 0;
  /// Active tiles, and inactive ones that may differ from the background.
  std::uint64_t stored = 0;
};

/// The shape of a tree in the layout 5-4-3, and what it takes to read it.
struct TreeOutline {
  std::uint64_t root_entries = 0;                    ///< tiles and children of the root
  std::uint64_t uppers = 0, lowers = 0, leaves = 0;  ///< nodes of 4096, 128 and 8 voxels
  TileCounts root_tiles, upper_tiles, lower_tiles;
  std::uint64_t active_voxels = 0;  ///< in leaves and tiles; at most 2^64 - 1
  VoxelBox active_box;              ///< tight around the active voxels
  VoxelBox stored_box;              ///< around all leaves and stored tiles

  std::uint64_t topology_bytes = 0;  ///< memory of OpenVDB's tree without the leaves' values
  std::uint64_t value_bytes = 0;     ///< memory of the leaves' values in OpenVDB's tree
  std::uint64_t volume_bytes = 0;  ///< most memory of a `Volume`'s columns while they are made
};

/// A map from voxels to the world along the axes: x becomes scale * x + translation.
struct AxisMap {
  bool scales = false, moves = false;  ///< which of the two the file states
  std::array<double, 3> scale{1, 1, 1};
  std::array<double, 3> translation{};
  std::array<double, 3> voxel_size{1, 1, 1};  ///< as the file states it
};

/// How far the bytes of a grid were looked at.
enum class WalkDepth : std::uint8_t {
  kValues,    ///< all of it: nodes, masks, and the frames of all value arrays
  kTopology,  ///< nodes and masks (point grids); the rest by its declared extent alone
  kSkipped,   ///< a tree of an unknown type: by its declared extent alone
};

struct GridOutline {
  std::string name;         ///< by shown_names: "name[0]", ... where several share one
  std::string unique_name;  ///< as stored: "name\x1e0", ...
  std::string tree_type;    ///< "Tree_float_5_4_3", ...; without the ending for half floats
  std::string grid_class;   ///< "level set", "fog volume", ...; empty when the file has none
  VdbCompression compression;
  bool half_float = false;
  bool instance = false;  ///< shares the tree of an earlier grid, whose outline this repeats
  WalkDepth depth = WalkDepth::kValues;
  TreeOutline tree;
  std::uint64_t metadata_at = 0;  ///< the byte of the file where its metadata begins
  std::uint64_t tree_at = 0;      ///< and its nodes; 0 of an instance
  std::optional<AxisMap> map;     ///< unless it is one of another kind
};

struct VdbOutline {
  std::uint32_t format = 0;  ///< 222 to 224
  std::uint32_t library_major = 0, library_minor = 0;
  bool has_offsets = false;  ///< whether one grid can be read without those before it
  std::uint64_t file_bytes = 0;
  std::vector<GridOutline> grids;  ///< in the file's order
};

}  // namespace tet
