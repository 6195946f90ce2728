// The labels of a segmentation's mesh: chosen, merged, and numbered anew.
#pragma once

#include <cstdint>
#include <limits>
#include <string_view>
#include <vector>

#include <absl/status/statusor.h>

#include "core/labels/label.h"
#include "core/mesh/tet_mesh.h"
#include "core/plan/label_choice.h"
#include "core/volume/label_volume.h"

namespace tet {

/// What there is to choose from.
struct KnownLabels {
  const std::vector<std::int64_t>& values;  ///< sorted, unique
  std::string_view of = "image";            ///< what has them, as messages call it
};

struct LabelNumbers {
  std::vector<Label> of_known;  ///< the number of each of the labels there are, in their order
  Label background = 0;         ///< of what lies beyond them
  /// By number, in the order of their values; the background comes last, and where it is left
  /// out it has the number behind the last.
  std::vector<MeshLabel> labels;
  /// How large the leaves of each of them may be, world units.
  std::vector<double> largest_leaf;
  static constexpr double kAnySize = std::numeric_limits<double>::infinity();
  KeptLabels kept = {};
};

/// Errors: kInvalidArgument (the choice names labels that there are not, or too many; the
/// message lists what there is), kFailedPrecondition (nothing but background).
absl::StatusOr<LabelNumbers> number_labels(const KnownLabels& known, const LabelChoice& choice);

/// The volume that the voxels of each label have in all of the image, world units cubed.
std::vector<double> voxel_volumes_of(const LabelVolume& volume, const LabelNumbers& numbers);

}  // namespace tet
