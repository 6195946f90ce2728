// What a public volume holds.
#pragma once

#include <memory>
#include <vector>

#include "core/volume/volume.h"
#include "tetstream/volume.h"

namespace tetstream {

struct Volume::Impl {
  /// One, or three of a vector field; none is null.
  std::vector<std::shared_ptr<const tet::Volume>> components;
};

}  // namespace tetstream
