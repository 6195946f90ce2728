// The rules of a mesh of labels once more, written as plainly as they read: maps over nodes, no
// bricks, no masks. Slow, and sharing nothing with the mesher but the lattice's directions.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "core/base/brick_box.h"
#include "tests/support/label_sources.h"

namespace tet::test {

struct LabelReference {
  std::uint64_t vertices = 0, tets = 0;
  std::map<Label, std::uint64_t> tets_of;
  double volume =
      0;  ///< of all that is meshed, spacings cubed; exact where nothing is left out
  /// Nodes that stay where they are and have a tet that is meshed, with their label.
  std::map<LatticeCoord, Label> staying;
};

/// The uniform meshes of a domain, at the limits of the warp that both sides have: for each of
/// at most 32 labels, that without its tets; kJoker leaves nothing out.
std::vector<LabelReference> reference_labels(const LabelFunctions& functions,
                                             const BrickBox& domain,
                                             const std::vector<Label>& left_out = {kJoker});

}  // namespace tet::test
