// The grids of a .vdb file, or an image, on this machine, by way of a decoder unless the file
// is trusted.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/volume/grid_contents.h"
#include "core/volume/grid_info.h"
#include "core/volume/label_volume.h"
#include "core/volume/volume.h"

namespace tet {

enum class FileTrust {
  kNone,  ///< another process reads it, which can do nothing else
  kFull,  ///< it is read here
};

/// What the commands say of their option for it.
inline constexpr const char* kTrustHelp =
    "Read the file in this process, not in one that can do nothing else: for files of your own";

/// Errors: those of load_volume; without trust those of decode_once and volume_of too.
absl::StatusOr<Volume> read_volume(const std::string& path,
                                   const std::string& grid_name,
                                   FileTrust trust,
                                   const Cancellation& interruption);

/// One component of a grid whose values are looked up. Errors: those of load_field; without
/// trust those of decode_once and volume_of too.
absl::StatusOr<Volume> read_field(const std::string& path,
                                  const std::string& grid_name,
                                  std::uint32_t component,
                                  FileTrust trust,
                                  const Cancellation& interruption);

/// An image's labels. Errors: those of load_labels; without trust those of decode_once and
/// labels_of too.
absl::StatusOr<LabelVolume> read_labels(const std::string& path,
                                        const std::string& grid_name,
                                        FileTrust trust,
                                        const Cancellation& interruption);

/// Errors: those of list_grids; without trust those of decode_once and grid_list_of too.
absl::StatusOr<std::vector<GridInfo>> read_grid_list(const std::string& path,
                                                     FileTrust trust,
                                                     const Cancellation& interruption);

/// What the values of one of a file's grids tell: of one that cannot be meshed, which only they
/// tell, why not. Errors: those of read_volume and read_labels but kFailedPrecondition.
absl::StatusOr<GridContents> read_contents(const std::string& path,
                                           const GridInfo& grid,
                                           FileTrust trust,
                                           const Cancellation& interruption);

/// Names of those that can be meshed, in the file's order.
std::vector<std::string> meshable_of(const std::vector<GridInfo>& grids);

}  // namespace tet
