// What a public scene holds.
#pragma once

#include <memory>
#include <vector>

#include "core/scene/scene.h"
#include "tetstream/scene.h"
#include "tetstream/v1/scene.pb.h"

namespace tetstream {

struct Scene::Impl {
  v1::Scene message;
  std::vector<SceneGrid> grids;            ///< that nodes name
  std::shared_ptr<const tet::Scene> core;  ///< null where a server stores some of its grids
};

}  // namespace tetstream
