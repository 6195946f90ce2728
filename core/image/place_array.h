// An array of NumPy as an image with a place in the world.
#pragma once

#include <string>

#include <absl/status/status.h>

#include "core/base/vec3.h"

namespace tet {

/// What an array does not say of itself.
struct ArrayPlace {
  /// Which of the world's axes the array's indices run along: "zyx" of one that is [z][y][x].
  std::string axes = "xyz";
  Triple spacing{1, 1, 1};  ///< along x, y, z; negative where an index runs against its axis
  Triple origin{0, 0, 0};   ///< of array[0, 0, 0]
  std::string space;        ///< "RAS", "LPS", or empty: not said

  friend bool operator==(const ArrayPlace&, const ArrayPlace&) = default;
};

/// Writes a `.npy` file as a NRRD file, which is made. Errors: those of reading the array's
/// header; kInvalidArgument (axes that are no order of x, y and z, a space that is none, a
/// spacing of 0).
absl::Status place_array(const std::string& array,
                         const ArrayPlace& place,
                         const std::string& image);

}  // namespace tet
