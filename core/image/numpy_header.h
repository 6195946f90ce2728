// Arrays of NumPy: https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/image/image_outline.h"

namespace tet {

bool is_numpy(std::span<const std::byte> head) noexcept;

/// An array is indexed [x][y][z], with voxels of 1 from the origin on: a file says nothing
/// else. Throws ImageRefusal.
ImageOutline read_numpy_header(std::span<const std::byte> head, std::uint64_t file_bytes);

}  // namespace tet
