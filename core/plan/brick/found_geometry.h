// Where the cut points and moved nodes of a counted mesh's bricks lie.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "core/field/phi_field.h"
#include "core/plan/brick/counted_mesh.h"
#include "core/plan/brick/survey.h"

namespace tet {

/// Packed geometry of one brick after another, found again where it was not kept.
class FoundGeometry {
 public:
  explicit FoundGeometry(const ComparedMesh& of) : of_(of), sampler_(of.field) {}

  /// Finds it of a brick at the surface. It is valid until the next one is asked for.
  std::span<const std::byte> of_brick(std::size_t brick);

 private:
  const ComparedMesh& of_;
  PhiSampler sampler_;
  std::unique_ptr<StuffingWorkspace> workspace_;
  std::vector<std::byte> packed_;
};

}  // namespace tet
