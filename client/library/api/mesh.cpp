#include "tetstream/mesh.h"

#include <utility>

#include "client/library/api/mesh_impl.h"

namespace tetstream {

Mesh::Mesh(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}

const MeshHeader& Mesh::header() const noexcept { return impl_->header; }
const MeshColumns& Mesh::columns() const noexcept { return impl_->columns; }
const Statistics& Mesh::statistics() const noexcept { return impl_->statistics; }

Point Mesh::vertex(std::size_t i) const noexcept {
  const auto [x, y, z] = columns().point(i);
  const Point& origin = header().origin;
  return {origin[0] + x, origin[1] + y, origin[2] + z};
}

}  // namespace tetstream
