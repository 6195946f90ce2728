// What is told of a stored file's grids: core's types and messages, both ways.
#pragma once

#include <absl/status/statusor.h>

#include "core/volume/grid_contents.h"
#include "core/volume/grid_info.h"
#include "tetstream/v1/grids.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

void to_proto(const GridInfo& info, v1::GridInfo& message);

/// Adds what the values tell.
void to_proto(const GridContents& contents, v1::GridInfo& message);

/// Texts are as the server has them, which may be anything.
GridInfo grid_info_of(const v1::GridInfo& message);

/// Values are unset where the message has none. Error: kInvalidArgument (a side or a source
/// that means nothing here).
absl::StatusOr<GridContents> contents_of(const v1::GridInfo& message);

}  // namespace tet
