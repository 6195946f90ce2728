#include "client/command/arguments/output_places.h"

#include <cstddef>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <absl/strings/str_cat.h>

#include "client/command/arguments/face_options.h"
#include "client/command/arguments/scene_input.h"
#include "core/base/posix/atomic_file.h"
#include "core/files/mesh_file.h"
#include "core/image/join_image.h"

namespace tet {
namespace {

/// Whether looking into the file leaves it as it is: a pipe must not be read before its time.
bool is_read_twice(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored);
}

/// The files that the command line or its scene names for reading, and names that are none.
std::vector<std::string> files_named(const MeshArguments& arguments,
                                     const MeshOptions& options) {
  std::vector<std::string> files{options.input, arguments.request.sizing.sizing,
                                 arguments.request.sizing.grid, arguments.request.labels.names};
  for (const VertexField& field : options.request.fields) files.push_back(field.file);
  for (const std::string& region : arguments.request.faces) {
    if (is_file_of_faces(region)) files.push_back(region);
  }
  if (!is_scene_file(options.input) || !is_read_twice(options.input)) return files;
  for (std::string& grid : grid_files_of_scene(options.input)) files.push_back(std::move(grid));
  return files;
}

/// Those, and the files that hold the data of those that are headers.
std::vector<std::string> files_read(const MeshArguments& arguments,
                                    const MeshOptions& options) {
  std::vector<std::string> files = files_named(arguments, options);
  const std::size_t named = files.size();
  for (std::size_t i = 0; i < named; ++i) {
    if (!is_read_twice(files[i])) continue;
    for (std::string& data : data_files_of(files[i])) files.push_back(std::move(data));
  }
  return files;
}

/// What is at `path` in the end. A folder, which may end with a slash, is replaced as a whole.
std::filesystem::path place_of_output(const std::string& path) {
  std::filesystem::path place = link_target(path);
  return place.has_filename() ? place : place.parent_path();
}

/// Whether writing `output` would take away `file`, which may be in a folder that is replaced.
bool takes_place_of(const std::filesystem::path& output, const std::string& file) {
  const auto place = link_target(file);
  return output == place || output == place.parent_path();
}

absl::Status check_report_place(const MeshOptions& options,
                                const std::vector<std::string>& mesh_files) {
  if (auto status = check_can_create(options.report); !status.ok()) return status;
  for (const std::string& file : mesh_files) {
    if (!takes_place_of(place_of_output(file), options.report)) continue;
    return absl::InvalidArgumentError(
        absl::StrCat("the report would take the place of the mesh: both are to be ", file,
                     "; name another file for one of them"));
  }
  return absl::OkStatus();
}

/// `what` and where it goes against all that is read.
absl::Status check_place_of(const std::string& what,
                            const std::string& output,
                            const std::vector<std::string>& files_read,
                            const std::string& read_for) {
  const auto place = place_of_output(output);
  for (const std::string& file : files_read) {
    if (file.empty() || !takes_place_of(place, file)) continue;
    return absl::InvalidArgumentError(absl::StrCat(what, " would take the place of ", file,
                                                   ", ", read_for, "; name another file for ",
                                                   what));
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status check_takes_no_place(const std::string& output,
                                  const std::vector<std::string>& files_read) {
  return check_place_of("the output", output, files_read, "which is read");
}

absl::Status check_output_places(const MeshArguments& arguments, const MeshOptions& options) {
  const auto output = mesh_output(options.output, options.format);
  if (!output.ok()) return output.status();
  const auto mesh_files = files_of(*output);
  if (!mesh_files.ok()) return mesh_files.status();
  const std::vector<std::string> read = files_read(arguments, options);
  constexpr const char* kReadFor = "which the mesh is made of";
  for (const std::string& file : *mesh_files) {
    const absl::Status status = check_place_of("the mesh", file, read, kReadFor);
    if (!status.ok()) return status;
  }
  if (options.report.empty()) return absl::OkStatus();
  if (auto status = check_report_place(options, *mesh_files); !status.ok()) return status;
  return check_place_of("the report", options.report, read, kReadFor);
}

}  // namespace tet
