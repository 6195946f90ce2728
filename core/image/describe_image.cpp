#include "core/image/describe_image.h"

#include <cmath>
#include <cstddef>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/volume/check_transform.h"

namespace tet {
namespace {

/// The letter of the direction that an axis runs to most: "R" for one that runs to x of RAS.
char letter_of(const VoxelTransform& transform, std::size_t axis, const std::string& world) {
  constexpr std::string_view kEnds = "RLAPSI";
  std::size_t row = 0;
  const auto& a = transform.linear;
  for (std::size_t i = 1; i < 3; ++i) {
    if (std::abs(a[i][axis]) > std::abs(a[row][axis])) row = i;
  }
  const std::size_t end = kEnds.find(world[row]);
  return a[row][axis] > 0 ? world[row] : kEnds[end ^ 1];
}

std::string where_axes_run(const ImageArray& array, const ImageSpace& space) {
  std::string text;
  if (space.axes.empty()) {
    text = "which way its axes run in a body is not said";
  } else {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      text += letter_of(array.transform, axis, space.axes);
    }
    text = absl::StrCat("its axes run to ", text, ", coordinates are ", space.axes);
  }
  if (!space.unit.empty()) absl::StrAppend(&text, " in ", space.unit);
  if (!space.note.empty()) absl::StrAppend(&text, "; ", space.note);
  return text;
}

}  // namespace

std::string describe_image(const ImageOutline& outline, const ImageArray& array) {
  const auto [x, y, z] = voxel_edges(array.transform);
  return absl::StrFormat("%s, %d x %d x %d voxels of %g x %g x %g%s; %s",
                         format_name(outline.format), array.size[0], array.size[1],
                         array.size[2], x, y, z, are_square(array.transform) ? "" : ", sheared",
                         where_axes_run(array, outline.space));
}

}  // namespace tet
