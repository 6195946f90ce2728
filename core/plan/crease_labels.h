// Labels of the patches that a region's faces are divided into.
#pragma once

#include <absl/status/status.h>

#include "core/base/cancel.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// Gives the faces of regions with creases, in the place of their label, those of their
/// patches: of `rim` the labels `rim.1`, with the most faces, `rim.2` and so on, of several
/// grids each grid's own. `rim` itself stays for faces that are in no patch, and where there is
/// no face at all.
///
/// `surface` is what find_crease_patches takes; all of its labels may get other numbers.
/// Parallel. Errors: kInvalidArgument (more patches than a mesh has labels for, or two labels
/// with one name; begins with the field), kCancelled, kDeadlineExceeded.
absl::Status divide_regions(TetMesh& surface, const Cancellation& cancellation = {});

}  // namespace tet
