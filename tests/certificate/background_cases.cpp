#include "tests/certificate/background_cases.h"

#include <cstdint>
#include <random>

#include "core/lattice/background_tets.h"
#include "tests/certificate/isometries.h"

namespace tet::certificate {
namespace {

/// Three doubled coordinates in one number, in place of a vertex's id.
using PackedPlace = std::uint64_t;

struct PlacesAsIds {
  static constexpr int kBits = 8, kZero = 64;

  static PackedPlace pack(int x, int y, int z) noexcept {
    const auto field = [](int at) { return static_cast<PackedPlace>(at + kZero); };
    return field(x) << (2 * kBits) | field(y) << kBits | field(z);
  }
  PackedPlace finer_corner(int x, int y, int z) const noexcept { return pack(x, y, z); }
  PackedPlace centre(int x, int y, int z) const noexcept {
    return pack(2 * x + 1, 2 * y + 1, 2 * z + 1);
  }
};

Corner unpacked(PackedPlace packed) {
  const auto at = [&](int field) {
    const auto value = static_cast<int>(packed >> (field * PlacesAsIds::kBits) & 0xff);
    return kUnit * (value - PlacesAsIds::kZero);
  };
  return {{at(2), at(1), at(0)}, {}};
}

/// Leaves, refined cells and neither, side by side in every way: more than 2:1 balance allows,
/// which only repeats tets.
BackgroundCells mixed_cells() {
  std::mt19937 random(1);
  BackgroundCells cells;
  cells.own = BrickMask::all();
  for (int x = -1; x <= kBrickEdge; ++x) {
    for (int y = -1; y <= kBrickEdge; ++y) {
      for (int z = -1; z <= kBrickEdge; ++z) {
        const auto kind = random() % 4;
        if (kind < 2) cells.leaf.set(halo_index(x, y, z));
        if (kind == 2) cells.refined.set(halo_index(x, y, z));
      }
    }
  }
  return cells;
}

}  // namespace

std::vector<Problem> background_cases() {
  const BackgroundCells cells = mixed_cells();
  std::vector<PackedPlace> corners(4 * count_background(cells).total());
  PlacesAsIds places;
  BackgroundCounts written;
  write_background(cells, places, corners.data(), written);
  std::vector<Problem> problems;
  for (std::size_t i = 0; i < corners.size(); i += 4) {
    Problem problem;
    problem.name = "background";
    problem.tets.push_back({unpacked(corners[i]), unpacked(corners[i + 1]),
                            unpacked(corners[i + 2]), unpacked(corners[i + 3])});
    problems.push_back(problem);
  }
  return without_copies(problems);
}

}  // namespace tet::certificate
