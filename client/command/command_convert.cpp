// `tetstream convert`: a surface in, a .vdb level set out; or an array of NumPy, and an image.
#include <cstdio>
#include <fcntl.h>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <absl/strings/ascii.h>
#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_replace.h>

#include "client/command/arguments/placed_array.h"
#include "client/command/arguments/surface_input.h"
#include "client/command/command.h"
#include "client/command/process/abandonable.h"
#include "client/command/process/progress_bar.h"
#include "client/command/process/scratch_directory.h"
#include "core/base/posix/atomic_file.h"
#include "core/base/posix/file.h"
#include "core/base/posix/folder.h"
#include "core/base/printable.h"
#include "core/image/place_array.h"
#include "core/vdb/openvdb/openvdb_part.h"

namespace tet {
namespace {

namespace fs = std::filesystem;

constexpr const char* kConvertExamples = R"(
A closed surface becomes the level set of what it goes around: solids that overlap are one, and a
surface that is wound inwards within another is a cavity. Small holes are closed, and that is said.
A surface that is open has no inside: it is refused unless --open says what to make of it.

Examples:
  tetstream convert part.stl part.vdb --voxel 0.5
  tetstream convert bunny.ply bunny.vdb          voxels of the longest extent / 128
  tetstream convert scan.ply scan.vdb --open close   its holes get caps
  tetstream convert ct.npy ct.nrrd --axes zyx --spacing3 0.5 0.5 1.5 --origin -120 -80 40

An array of NumPy becomes an image with a place in the world, which its file does not have:
docs/images.md.
)";

struct ConvertOptions {
  std::string input, output;
  SurfaceChoices surface;
  ArrayPlace place;
};

bool ends_in(const std::string& path, const char* ending) {
  return absl::EndsWith(absl::AsciiStrToLower(path), ending);
}

bool is_array(const ConvertOptions& options) { return ends_in(options.input, ".npy"); }

absl::Status check_options(const ConvertOptions& options) {
  if (is_array(options)) {
    if (ends_in(options.output, ".nrrd")) return check_can_create(options.output);
    return absl::InvalidArgumentError(
        absl::StrCat("the output ", options.output, " of an array must end in .nrrd"));
  }
  if (!is_surface_file(options.input)) {
    return absl::InvalidArgumentError(
        absl::StrCat("the input ", options.input, " must end in .obj, .stl, .ply or .npy"));
  }
  if (!ends_in(options.output, ".vdb")) {
    return absl::InvalidArgumentError(
        absl::StrCat("the output ", options.output, " must end in .vdb"));
  }
  return check_can_create(options.output);
}

/// An error in writing `made`, told of the file that was asked for.
absl::Status told_of_output(const absl::Status& status,
                            const std::string& made,
                            const ConvertOptions& options) {
  return absl::Status(status.code(), absl::StrReplaceAll(std::string(status.message()),
                                                         {{made, options.output}}));
}

/// Reads and converts into `made`; errors name the file that was asked for.
absl::StatusOr<ConversionReport> convert(const ConvertOptions& options,
                                         const std::string& made) {
  const absl::StatusOr<SurfaceInput> input = read_surface_input(options.input, options.surface);
  if (!input.ok()) return input.status();
  const auto report = with_openvdb([&](const OpenVdbPart& part) {
    return part.surface_to_vdb(input->surface, input->voxel_size, made, input->open);
  });
  if (report.ok()) return report;
  return told_of_output(report.status(), made, options);
}

/// Where the output is written until it is whole: beside what has its name in the end, which
/// behind a symbolic link may be in another file system.
fs::path folder_of_output(const ConvertOptions& options) {
  return link_target(options.output).parent_path();
}

/// Whole and on the disk before it has its name; behind a symbolic link it takes the place of
/// the file that this leads to, as all outputs do.
absl::Status move_to_output(const std::string& made, const ConvertOptions& options) {
  absl::StatusOr<File> file = File::open(made, O_RDONLY, io_error);
  if (!file.ok()) return told_of_output(file.status(), made, options);
  absl::Status status = file->sync();
  if (status.ok()) status = move_file(made, link_target(options.output), io_error);
  return told_of_output(status, made, options);
}

absl::Status convert_array(const ConvertOptions& options, const Cancellation& interruption) {
  const auto scratch = ScratchDirectory::make(folder_of_output(options));
  if (!scratch.ok()) return scratch.status();
  const std::string made = scratch->file("made.nrrd");
  const absl::Status status =
      place_array_abandonable(options.input, options.place, made, interruption);
  if (!status.ok()) return told_of_output(status, made, options);
  if (auto moved = move_to_output(made, options); !moved.ok()) return moved;
  std::printf("%s: an image of %s\n", for_terminal(options.output).c_str(),
              for_terminal(options.input).c_str());
  return absl::OkStatus();
}

/// The file is written beside the output, where nothing is left of it if it is not finished.
absl::Status run_convert(const ConvertOptions& options, const Cancellation& interruption) {
  if (auto status = check_options(options); !status.ok()) return status;
  if (is_array(options)) return convert_array(options, interruption);
  const auto scratch = ScratchDirectory::make(folder_of_output(options));
  if (!scratch.ok()) return scratch.status();
  const std::string made = scratch->file("made.vdb");
  ProgressBar bar;
  bar.begin("converting");
  const absl::StatusOr<ConversionReport> report =
      run_abandonable<ConversionReport>([options, made] { return convert(options, made); },
                                        [&] { bar.update(0, 0); }, interruption);
  if (!report.ok()) return report.status();
  if (auto moved = move_to_output(made, options); !moved.ok()) return moved;
  bar.say(options.output + ": " + report->text(), stdout);
  for (const std::string& warning : report->warnings()) bar.say("warning: " + warning);
  return absl::OkStatus();
}

}  // namespace

Command add_convert_command(CLI::App& app) {
  const auto options = std::make_shared<ConvertOptions>();
  app.footer(kConvertExamples);
  app.add_option("IN", options->input, "A .obj, .stl or .ply surface, or a .npy array")
      ->required();
  app.add_option("OUT", options->output, "The .vdb file to write; of an array the .nrrd")
      ->required();
  describe_surface(app, options->surface);
  describe_place(app, options->place);
  return [options](const Cancellation& interruption) {
    return run_convert(*options, interruption);
  };
}

}  // namespace tet
