// An array of NumPy with a place in the world, which its file does not have.
#pragma once

#include <optional>
#include <string>

#include <absl/status/statusor.h>

#include "client/command/arguments/mesh_options.h"
#include "client/library/api/temporary_folder.h"
#include "core/base/cancel.h"

namespace CLI {
class App;
}

namespace tet {

/// Adds --axes, --spacing3, --origin and --space.
void describe_place(CLI::App& app, ArrayPlace& place);

/// place_array, left behind where the user interrupts it: an array may have any size. Errors:
/// also kCancelled; they name the array.
absl::Status place_array_abandonable(const std::string& array,
                                     const ArrayPlace& place,
                                     const std::string& image,
                                     const Cancellation& interruption);

/// The image that an array is as long as this exists.
class PlacedArray {
 public:
  /// Where the options give the input a place, makes an image of it and puts that in the
  /// input's place. Errors: those of place_array_abandonable;
  /// kInvalidArgument (the input is no array).
  static absl::StatusOr<PlacedArray> of(MeshOptions& options, const Cancellation& interruption);

 private:
  std::optional<tetstream::TemporaryFolder> folder_;
};

}  // namespace tet
