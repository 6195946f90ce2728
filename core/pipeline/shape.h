// What is meshed.
#pragma once

#include <memory>
#include <variant>

#include "core/grid/volume.h"

namespace tet {

struct Scene;

/// A grid or a scene; never null.
using Shape = std::variant<std::shared_ptr<const Volume>, std::shared_ptr<const Scene>>;

/// Null unless that is what is meshed.
inline const Volume* volume_of(const Shape& shape) noexcept {
  const auto* volume = std::get_if<std::shared_ptr<const Volume>>(&shape);
  return volume == nullptr ? nullptr : volume->get();
}
inline const Scene* scene_of(const Shape& shape) noexcept {
  const auto* scene = std::get_if<std::shared_ptr<const Scene>>(&shape);
  return scene == nullptr ? nullptr : scene->get();
}

}  // namespace tet
