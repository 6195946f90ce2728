// The labels of a segmentation's mesh: chosen, merged, and numbered anew.
#pragma once

#include <vector>

#include <absl/status/statusor.h>

#include "core/labels/label.h"
#include "core/mesh/tet_mesh.h"
#include "core/plan/label_choice.h"
#include "core/volume/label_volume.h"

namespace tet {

struct LabelNumbers {
  std::vector<Label> of_image;  ///< the number of each of the image's labels, in their order
  Label background = 0;         ///< of what lies beyond the image
  /// By number, in the order of their values; the background comes last, and where it is left
  /// out it has the number behind the last.
  std::vector<MeshLabel> labels;
  /// The volume that the voxels of each of them have in all of the image, world units cubed.
  std::vector<double> voxel_volume;
  KeptLabels kept = {};
};

/// Errors: kInvalidArgument (the choice names labels that there are not, or too many; the
/// message lists what there is), kFailedPrecondition (nothing but background).
absl::StatusOr<LabelNumbers> number_labels(const LabelVolume& volume,
                                           const LabelChoice& choice);

}  // namespace tet
