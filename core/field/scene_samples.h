// phi of a scene on a brick of the lattice and its halo.
#pragma once

#include "core/base/types.h"
#include "core/field/phi_field.h"
#include "core/scene/scene_evaluator.h"

namespace tet {

/// Focuses on a lattice brick and its halo; `spacing` in world units.
void focus_on_samples(SceneEvaluator& evaluator, double spacing, BrickCoord brick) noexcept;

/// Fills `samples` for a lattice brick; `spacing` in world units. A node's sample depends on
/// the node alone, whichever bricks see it. Leaves the evaluator focused on the brick and its
/// halo.
void sample_scene(SceneEvaluator& evaluator,
                  double spacing,
                  BrickCoord brick,
                  BrickSamples& samples) noexcept;

}  // namespace tet
