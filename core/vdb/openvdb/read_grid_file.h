// Grids of files in, whatever is needed to read them: OpenVDB where nothing else will do.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/posix/file.h"
#include "core/vdb/openvdb/openvdb_part.h"
#include "core/vdb/plain/load_limits.h"
#include "core/volume/grid_info.h"
#include "core/volume/label_volume.h"
#include "core/volume/volume.h"

namespace tet {

/// Finds OpenVDB; in a process that may load nothing any more it says why there is none.
using FindOpenVdb = std::function<absl::StatusOr<const OpenVdbPart*>()>;

/// Reads the grids of one file, as load.h does. Errors of all members: those of the functions
/// of load.h, and of `find_openvdb`.
class GridFileReader {
 public:
  explicit GridFileReader(const OpenGridFile& file,
                          const LoadLimits& limits = {},
                          FindOpenVdb find_openvdb = openvdb_part)
      : file_(file), limits_(limits), find_openvdb_(std::move(find_openvdb)) {}

  absl::StatusOr<std::vector<GridInfo>> list() const;
  /// The list, where walking over the file tells all of it, which any process may do. Errors:
  /// those of the walk alone.
  absl::StatusOr<std::optional<std::vector<GridInfo>>> list_by_walking() const;
  absl::StatusOr<Volume> volume(const std::string& grid_name) const;
  absl::StatusOr<Volume> field(const std::string& grid_name, std::uint32_t component) const;
  absl::StatusOr<LabelVolume> labels(const std::string& grid_name) const;

 private:
  OpenGridFile file_;
  LoadLimits limits_;
  FindOpenVdb find_openvdb_;
};

/// Opens a file for it. Errors: those of check_file; kInvalidArgument (it cannot be opened).
absl::StatusOr<File> open_grid_file(const std::string& path);

/// Calls `read(GridFileReader)` of the file at `path`, or says why it cannot be opened.
template <class Read>
auto with_grid_file(const std::string& path, const Read& read)
    -> decltype(read(std::declval<const GridFileReader&>())) {
  const absl::StatusOr<File> file = open_grid_file(path);
  const auto size = file.ok() ? file->size() : file.status();
  if (!size.ok()) return size.status();
  return read(
      GridFileReader({file->descriptor().number(), static_cast<std::int64_t>(*size), path}));
}

}  // namespace tet
