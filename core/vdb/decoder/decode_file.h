// A file's grids by way of another process, in place of load.h's by way of this one.
#pragma once

#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/vdb/decoder/decoder_pool.h"
#include "core/volume/grid_contents.h"
#include "core/volume/grid_info.h"
#include "core/volume/label_volume.h"
#include "core/volume/volume.h"

namespace tet {

/// What a decoder made of a file, checked and copied. Errors: kInvalidArgument with
/// DECODER_RESULT (it is not what was asked for), kCancelled; those of `block`.
absl::StatusOr<Volume> volume_of(const absl::StatusOr<SealedBlock>& block,
                                 const FileRequest& request,
                                 const Cancellation& cancellation = Cancellation());
absl::StatusOr<LabelVolume> labels_of(const absl::StatusOr<SealedBlock>& block,
                                      const FileRequest& request,
                                      const Cancellation& cancellation = Cancellation());
absl::StatusOr<GridContents> contents_of(const absl::StatusOr<SealedBlock>& block,
                                         const FileRequest& request);
absl::StatusOr<std::vector<GridInfo>> grid_list_of(const absl::StatusOr<SealedBlock>& block,
                                                   const FileRequest& request);

}  // namespace tet
