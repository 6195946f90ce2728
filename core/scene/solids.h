// The solids that a scene is the union of, each as a scene of its own.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/scene/scene.h"

namespace tet {

/// Scenes of `scene.solids`, in their order: each has the values that it has as a part.
std::vector<std::shared_ptr<const Scene>> solids_of(const Scene& scene);

/// What their nodes are called, in their order; empty names of those that have none.
std::vector<std::string> names_of_solids(const Scene& scene);

}  // namespace tet
