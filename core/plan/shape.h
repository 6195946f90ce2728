// What is meshed.
#pragma once

#include <memory>
#include <variant>
#include <vector>

#include "core/volume/volume.h"

namespace tet {

struct LabelVolume;
struct Scene;

/// Several grids, each meshed by itself, and their meshes joined: see joined_plan.h. None is
/// null.
using GridList = std::vector<std::shared_ptr<const Volume>>;

/// A grid, a scene, several grids, or a segmentation; never null.
using Shape = std::variant<std::shared_ptr<const Volume>,
                           std::shared_ptr<const Scene>,
                           GridList,
                           std::shared_ptr<const LabelVolume>>;

/// Null unless that is what is meshed.
inline const Volume* volume_of(const Shape& shape) noexcept {
  const auto* volume = std::get_if<std::shared_ptr<const Volume>>(&shape);
  return volume == nullptr ? nullptr : volume->get();
}
inline const Scene* scene_of(const Shape& shape) noexcept {
  const auto* scene = std::get_if<std::shared_ptr<const Scene>>(&shape);
  return scene == nullptr ? nullptr : scene->get();
}
inline const GridList* grids_of(const Shape& shape) noexcept {
  return std::get_if<GridList>(&shape);
}
inline std::shared_ptr<const LabelVolume> labels_of(const Shape& shape) noexcept {
  const auto* labels = std::get_if<std::shared_ptr<const LabelVolume>>(&shape);
  return labels == nullptr ? nullptr : *labels;
}

}  // namespace tet
