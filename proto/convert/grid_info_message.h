// What a stored file's grids are, as messages.
#pragma once

#include "core/volume/grid_info.h"
#include "tetstream/v1/grids.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

void to_proto(const GridInfo& info, v1::GridInfo& message);

}  // namespace tet
