// A survey that other hosts made, for whoever plans the mesh.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace tet {

/// A survey that was made before, in blocks of so many bricks near the surface.
struct SurveyedBlocks {
  std::size_t block_bricks = 0;
  /// Returns the bytes of one block, or nothing where it has to be surveyed again. Null where
  /// all of them have.
  std::function<std::optional<std::vector<std::byte>>(std::size_t block)> find = nullptr;
};

}  // namespace tet
