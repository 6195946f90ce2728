#include "core/volume/volume.h"

#include <algorithm>
#include <limits>

namespace tet {
namespace {

template <class T>
std::size_t bytes_of(const std::vector<T>& column) noexcept {
  return column.capacity() * sizeof(T);
}

}  // namespace

bool VoxelTransform::mirrors() const noexcept {
  const auto& [a, b, c] = linear;
  const double determinant = a[0] * (b[1] * c[2] - b[2] * c[1]) -
                             a[1] * (b[0] * c[2] - b[2] * c[0]) +
                             a[2] * (b[0] * c[1] - b[1] * c[0]);
  return determinant < 0;
}

WorldBox VoxelTransform::to_world_box(const VoxelPoint& min,
                                      const VoxelPoint& max) const noexcept {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  WorldBox box{{kInf, kInf, kInf}, {-kInf, -kInf, -kInf}};
  for (int corner = 0; corner < 8; ++corner) {
    const WorldPoint p = to_world(
        {corner & 1 ? max.x : min.x, corner & 2 ? max.y : min.y, corner & 4 ? max.z : min.z});
    box.min = {std::min(box.min.x, p.x), std::min(box.min.y, p.y), std::min(box.min.z, p.z)};
    box.max = {std::max(box.max.x, p.x), std::max(box.max.y, p.y), std::max(box.max.z, p.z)};
  }
  return box;
}

std::size_t Volume::size_bytes() const noexcept {
  return sizeof(*this) + name.capacity() + bytes_of(bricks) + bytes_of(values) +
         bytes_of(ranges) + bytes_of(regions) + bytes_of(cubes);
}

}  // namespace tet
