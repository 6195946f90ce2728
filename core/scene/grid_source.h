// A grid as a scene keeps it.
#pragma once

#include <memory>
#include <utility>

#include "core/volume/value_bounds.h"
#include "core/volume/volume.h"

namespace tet::scene {

struct GridSource {
  std::shared_ptr<const Volume> volume;
  ValueBounds bounds;

  explicit GridSource(std::shared_ptr<const Volume> of)
      : volume(std::move(of)), bounds(*volume) {}
};

}  // namespace tet::scene
