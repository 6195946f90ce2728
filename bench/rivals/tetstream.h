// tetstream on the same image.
#pragma once

#include "bench/rivals/contender.h"
#include "bench/rivals/grains.h"

namespace tet::rivals {

/// A uniform mesh of all labels but the background, in this process, on one thread.
PlainMesh mesh_with_tetstream(const LabelCube& cube, double spacing);

}  // namespace tet::rivals
