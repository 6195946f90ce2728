// Images in, volumes out.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/posix/byte_source.h"
#include "core/volume/grid_info.h"
#include "core/volume/label_volume.h"
#include "core/volume/volume.h"

namespace tet {

inline constexpr std::uint64_t kNoLimit = ~std::uint64_t{0};

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
/// kFailedPrecondition (values that are not finite, or all the same), kResourceExhausted (a
/// packed file that is longer than it claims, and takes more to be read than it may).
absl::StatusOr<Volume> load_image(const ByteSource& source,
                                  const std::string& name,
                                  ImageUse use,
                                  std::uint64_t most_reading_bytes = kNoLimit);

/// One array as labels. Errors: also kFailedPrecondition (values that are no whole numbers, or
/// more different ones than a segmentation has).
absl::StatusOr<LabelVolume> load_labels(const ByteSource& source,
                                        const std::string& name,
                                        std::uint64_t most_reading_bytes = kNoLimit);

}  // namespace tet
