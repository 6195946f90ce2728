// What is measured of each contender, in a process of its own.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace tet::rivals {

/// A mesh as plain arrays, however it was made.
struct PlainMesh {
  std::vector<std::array<double, 3>> vertex;
  std::vector<std::array<std::uint32_t, 4>> tet;
  std::vector<std::uint8_t> label;  ///< of each tet
  double cpu_seconds = 0;           ///< from the image in memory to the mesh in memory
  double peak_bytes = 0;            ///< held meanwhile, above what was held before
};

struct Result {
  std::uint64_t tets = 0;
  int labels = 0;  ///< that some tet has
  double cpu_seconds = 0, peak_bytes = 0;
  double min_deg = 180, max_deg = 0;  ///< dihedral angles
};

/// Makes a mesh in a child process and measures it there. Ends the program where that fails.
Result measure(const std::function<PlainMesh()>& make);

/// CPU time of this process.
double cpu_seconds();

}  // namespace tet::rivals
