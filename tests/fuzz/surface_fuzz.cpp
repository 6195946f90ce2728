// Readers of surfaces against anything: they accept or refuse, in words that can be shown; and
// what they accept can be converted: its ids are of vertices that there are, and all is finite.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/surface/default_voxel.h"
#include "core/triangle_files/surface_format.h"
#include "tests/fuzz/fuzz_target.h"

namespace tet::surface_fuzz {

TET_FUZZ_TARGET(surface_fuzz) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto surface = read_surface_bytes(bytes);
  if (!surface.ok()) {
    require(absl::IsInvalidArgument(surface.status()));
    require(!surface.status().message().empty());
    return 0;
  }
  require(!surface->triangles.empty());
  for (const auto& triangle : surface->triangles) {
    for (const std::uint32_t id : triangle) require(id < surface->vertices.size());
  }
  for (const WorldPoint& p : surface->vertices) {
    require(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
  }
  require(default_voxel(*surface) >= 0);
  return 0;
}

}  // namespace tet::surface_fuzz
