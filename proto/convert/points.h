// Points and boxes as messages, and back.
#pragma once

#include "core/base/types.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

void to_proto(const WorldPoint& point, v1::Point& message);
void to_proto(const WorldBox& box, v1::Box& message);

/// The coordinates are taken as they are: is_finite tells whether they can be a place.
WorldPoint from_proto(const v1::Point& message);
WorldBox from_proto(const v1::Box& message);

bool is_finite(const v1::Point& message);
bool is_finite(const v1::Box& message);

}  // namespace tet
