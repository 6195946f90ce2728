#include "client/command/report_place.h"

#include <cstddef>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <absl/strings/str_cat.h>

#include "client/command/face_options.h"
#include "client/command/scene_input.h"
#include "core/base/posix/atomic_file.h"
#include "core/files/mesh_file.h"
#include "core/image/join_image.h"

namespace tet {
namespace {

/// The files that the command line or its scene names for reading, and names that are none.
std::vector<std::string> files_named(const MeshArguments& arguments,
                                     const MeshOptions& options) {
  std::vector<std::string> files{options.input, arguments.request.sizing.sizing,
                                 arguments.request.sizing.grid, arguments.request.labels.names};
  for (const VertexField& field : options.request.fields) files.push_back(field.file);
  for (const std::string& region : arguments.request.faces) {
    if (is_file_of_faces(region)) files.push_back(region);
  }
  if (!is_scene_file(options.input)) return files;
  for (std::string& grid : grid_files_of_scene(options.input)) files.push_back(std::move(grid));
  return files;
}

/// Those, and the files that hold the data of those that are headers.
std::vector<std::string> files_read(const MeshArguments& arguments,
                                    const MeshOptions& options) {
  std::vector<std::string> files = files_named(arguments, options);
  const std::size_t named = files.size();
  for (std::size_t i = 0; i < named; ++i) {
    std::error_code ignored;  // a pipe must not be read before its time
    if (!std::filesystem::is_regular_file(files[i], ignored)) continue;
    for (std::string& data : data_files_of(files[i])) files.push_back(std::move(data));
  }
  return files;
}

}  // namespace

absl::Status check_report_place(const MeshArguments& arguments, const MeshOptions& options) {
  if (options.report.empty()) return absl::OkStatus();
  if (auto status = check_can_create(options.report); !status.ok()) return status;
  const auto output = mesh_output(options.output, options.format);
  if (!output.ok()) return output.status();
  const auto written = files_of(*output);
  if (!written.ok()) return written.status();
  const auto place = link_target(options.report);
  for (const std::string& file : *written) {
    // A folder, which may end with a slash, is replaced as a whole.
    std::filesystem::path made = link_target(file);
    if (!made.has_filename()) made = made.parent_path();
    if (made != place && made != place.parent_path()) continue;
    return absl::InvalidArgumentError(
        absl::StrCat("the report would take the place of the mesh: both are to be ", file,
                     "; name another file for one of them"));
  }
  for (const std::string& file : files_read(arguments, options)) {
    if (file.empty() || link_target(file) != place) continue;
    return absl::InvalidArgumentError(
        absl::StrCat("the report would take the place of ", file,
                     ", which the mesh is made of; name another file for the report"));
  }
  return absl::OkStatus();
}

}  // namespace tet
