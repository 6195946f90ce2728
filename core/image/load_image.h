// Images in, volumes out.
#pragma once

#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/posix/byte_source.h"
#include "core/volume/grid_info.h"
#include "core/volume/label_volume.h"
#include "core/volume/volume.h"

namespace tet {

/// What an image is read for.
enum class ImageUse : std::uint8_t {
  kSurface,  ///< to be meshed
  kField,    ///< values to be looked up
};

/// The arrays of a file, whose values are not read. Errors: kInvalidArgument (broken),
/// kFailedPrecondition (what is not read: says what to do).
absl::StatusOr<std::vector<GridInfo>> list_image(const ByteSource& source);

/// One array as a volume; an empty `name` takes the only one that will do.
///
/// Beyond the image there is its least value; of one whose values have both signs, as signed
/// distances have, its greatest where the image's faces are nearer to that. Its class is
/// nobody's: core/volume/inside.h says what that means. Errors: also kNotFound (no such array),
/// kFailedPrecondition (values that are not finite, or all the same).
absl::StatusOr<Volume> load_image(const ByteSource& source,
                                  const std::string& name,
                                  ImageUse use);

/// One array as labels. Errors: also kFailedPrecondition (values that are no whole numbers, or
/// more different ones than a segmentation has).
absl::StatusOr<LabelVolume> load_labels(const ByteSource& source, const std::string& name);

}  // namespace tet
