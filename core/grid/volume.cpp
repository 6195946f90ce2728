#include "core/grid/volume.h"

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

std::size_t Volume::size_bytes() const noexcept {
  return sizeof(*this) + name.capacity() + bytes_of(bricks) + bytes_of(values) +
         bytes_of(ranges) + bytes_of(regions) + bytes_of(cubes);
}

}  // namespace tet
