// An array of NumPy with a place in the world, which its file does not have.
#pragma once

#include <optional>

#include <absl/status/statusor.h>

#include "client/command/mesh_options.h"
#include "client/library/api/temporary_folder.h"

namespace CLI {
class App;
}

namespace tet {

/// Adds --axes, --spacing3, --origin and --space.
void describe_place(CLI::App& app, ArrayPlace& place);

/// The image that an array is as long as this exists.
class PlacedArray {
 public:
  /// Where the options give the input a place, makes an image of it and puts that in the
  /// input's place. Errors: those of place_array; kInvalidArgument (the input is no array).
  static absl::StatusOr<PlacedArray> of(MeshOptions& options);

 private:
  std::optional<tetstream::TemporaryFolder> folder_;
};

}  // namespace tet
