#include "core/plan/brick/found_geometry.h"

#include <cstdint>

#include "core/stuffing/brick_geometry.h"

namespace tet {

std::span<const std::byte> FoundGeometry::of_brick(std::size_t brick) {
  const Survey& survey = of_.mesh.survey();
  const std::uint32_t at = of_.mesh.stuffed(brick);
  const StuffedBrick& stuffed = survey.stuffed[at];
  const std::size_t size = GeometrySizes(stuffed).bytes();
  if (const std::byte* kept = survey.geometry.of_brick[at]) return {kept, size};
  if (workspace_ == nullptr) {
    workspace_ = std::make_unique_for_overwrite<StuffingWorkspace>();
    packed_.resize(kMaxGeometryBytes);
  }
  stuff_brick(sampler_, of_.mesh.tree().levels[0].bricks[brick], of_.mesh.rules(),
              of_.mesh.restored(), *workspace_);
  pack_geometry(workspace_->lattice, stuffed, packed_.data());
  return {packed_.data(), size};
}

}  // namespace tet
