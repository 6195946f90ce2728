#include "client/command/arguments/placed_array.h"

#include <filesystem>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>
#include <absl/status/status.h>
#include <absl/strings/ascii.h>
#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>

#include "client/command/process/abandonable.h"

namespace tet {

void describe_place(CLI::App& app, ArrayPlace& place) {
  app.add_option(
         "--axes", place.axes,
         "Which axes an array's indices run along, as zyx of one that is [z][y][x] [xyz]")
      ->type_name("ORDER");
  app.add_option(
         "--spacing3", place.spacing,
         "Of an array's voxels along x, y and z; negative where it runs against the axis "
         "[1 1 1]")
      ->type_name("X Y Z");
  app.add_option("--origin", place.origin, "Where array[0, 0, 0] is [0 0 0]")
      ->type_name("X Y Z");
  app.add_option("--space", place.space, "What x, y and z are: RAS or LPS [not said]")
      ->type_name("SPACE");
}

absl::Status place_array_abandonable(const std::string& array,
                                     const ArrayPlace& place,
                                     const std::string& image,
                                     const Cancellation& interruption) {
  const auto work = [=]() -> absl::StatusOr<bool> {
    const absl::Status status = place_array(array, place, image);
    if (status.ok()) return true;
    return absl::Status(status.code(), absl::StrCat("'", array, "': ", status.message()));
  };
  return run_abandonable<bool>(work, {}, interruption).status();
}

absl::StatusOr<PlacedArray> PlacedArray::of(MeshOptions& options,
                                            const Cancellation& interruption) {
  PlacedArray placed;
  if (options.place == ArrayPlace()) return placed;
  if (!absl::EndsWith(absl::AsciiStrToLower(options.input), ".npy")) {
    return absl::InvalidArgumentError(
        absl::StrCat("--axes, --spacing3, --origin and --space give an array (.npy) a place, "
                     "and ",
                     options.input, " is none"));
  }
  absl::StatusOr<tetstream::TemporaryFolder> folder = tetstream::TemporaryFolder::make();
  if (!folder.ok()) return folder.status();
  const std::string stem = std::filesystem::path(options.input).stem().string();
  const std::string image = folder->file(absl::StrCat(stem, ".nrrd"));
  const absl::Status made =
      place_array_abandonable(options.input, options.place, image, interruption);
  if (!made.ok()) return made;
  options.input = image;
  placed.folder_.emplace(*std::move(folder));
  return placed;
}

}  // namespace tet
