// What the faces of a finest brick's tets depend on, beside the nodes around its cells.
#pragma once

#include "core/stuffing/stuffed_brick.h"

namespace tet {

class DomainFaces;

struct FacesAround {
  const BrickSurroundings& around;
  const DomainFaces* domain = nullptr;  ///< null where the brick is not at the domain's end
};

}  // namespace tet
