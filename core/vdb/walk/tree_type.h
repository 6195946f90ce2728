// The trees that OpenVDB's reader builds, by the names that files have for them.
#pragma once

#include <cstdint>
#include <string_view>

namespace tet {

/// What follows a leaf's mask in the file.
enum class LeafLayout : std::uint8_t {
  kValues,  ///< an array of values, perhaps compressed
  kBits,    ///< its origin, then a bit for each value
  kMask,    ///< its origin; the mask is all there is
  kPoints,  ///< attributes of points, which are not walked
};

/// A tree in the layout 5-4-3.
struct TreeType {
  std::string_view name;
  std::uint32_t value_bytes = 0;
  std::uint32_t half_bytes = 0;  ///< of a value stored as half floats; 0 when it never is
  LeafLayout leaves = LeafLayout::kValues;
};

/// The type of that name; nullptr when OpenVDB's reader does not know it either.
const TreeType* find_tree_type(std::string_view name) noexcept;

}  // namespace tet
