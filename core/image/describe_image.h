// An image's place in the world, for people.
#pragma once

#include <string>

#include "core/image/image_outline.h"

namespace tet {

/// One line: the format, the voxels and their edges, where the image's axes run to, and what
/// its coordinates are.
std::string describe_image(const ImageOutline& outline, const ImageArray& array);

}  // namespace tet
