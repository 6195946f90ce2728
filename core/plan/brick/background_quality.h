// Statistics of background tets, which are of a few shapes: none of them is measured twice.
#pragma once

#include "core/base/quality_stats.h"
#include "core/lattice/background.h"
#include "core/mesh/lattice_to_world.h"

namespace tet {

/// Adds the tets of leaves of a level; volumes are in units of the finest spacing.
void add_background_quality(const BackgroundCounts& counts,
                            int level,
                            QualityStats& stats) noexcept;

/// What a volume in units of the spacing is in the world.
double volume_scale(const LatticeToWorld& to_world) noexcept;

}  // namespace tet
