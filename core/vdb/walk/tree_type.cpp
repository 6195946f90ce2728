#include "core/vdb/walk/tree_type.h"

#include <algorithm>
#include <array>

namespace tet {
namespace {

/// Every grid type that openvdb::initialize registers; a test compares.
constexpr std::array kTreeTypes{
    TreeType{"Tree_float_5_4_3", 4, 2},
    TreeType{"Tree_double_5_4_3", 8, 2},
    TreeType{"Tree_int32_5_4_3", 4},
    TreeType{"Tree_int64_5_4_3", 8},
    TreeType{"Tree_vec3i_5_4_3", 12},
    TreeType{"Tree_vec3s_5_4_3", 12, 6},
    TreeType{"Tree_vec3d_5_4_3", 24, 6},
    TreeType{"Tree_bool_5_4_3", 1, 0, LeafLayout::kBits},
    TreeType{"Tree_mask_5_4_3", 1, 0, LeafLayout::kMask},
    TreeType{"Tree_ptidx32_5_4_3", 4, 0, LeafLayout::kPoints},
    TreeType{"Tree_ptdataidx32_5_4_3", 4, 0, LeafLayout::kPoints},
};

}  // namespace

const TreeType* find_tree_type(std::string_view name) noexcept {
  const auto* found = std::find_if(kTreeTypes.begin(), kTreeTypes.end(),
                                   [&](const TreeType& type) { return type.name == name; });
  return found == kTreeTypes.end() ? nullptr : found;
}

}  // namespace tet
