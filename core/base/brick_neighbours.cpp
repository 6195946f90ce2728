#include "core/base/brick_neighbours.h"

#include <algorithm>
#include <bit>

namespace tet {

PlacesAround places_around(const BrickIndex& index, BrickCoord brick) noexcept {
  PlacesAround around;
  for (int o = 0; o < 27; ++o) {
    around[static_cast<std::size_t>(o)] =
        index.find({brick.x + o / 9 - 1, brick.y + o / 3 % 3 - 1, brick.z + o % 3 - 1});
  }
  return around;
}

/// Two bricks of each row are known, and where the third would be.
void BrickNeighbours::move_along_z(BrickCoord brick) noexcept {
  for (unsigned rows = static_cast<unsigned>(rows_); rows != 0; rows &= rows - 1) {
    const auto row = static_cast<std::size_t>(std::countr_zero(rows));
    const auto r = static_cast<std::int32_t>(row);
    std::uint32_t* const places = &places_[row * 3];
    row_[row] += places[0] != kNoBrick ? 1 : 0;
    places[0] = places[1];
    places[1] = places[2];
    const std::size_t next =
        row_[row] + (places[0] != kNoBrick ? 1 : 0) + (places[1] != kNoBrick ? 1 : 0);
    const BrickCoord at{brick.x + r / 3 - 1, brick.y + r % 3 - 1, brick.z + 1};
    const bool found = next < bricks_.size() && bricks_[next] == at;
    places[2] = found ? static_cast<std::uint32_t>(next) : kNoBrick;
  }
}

const PlacesAround& BrickNeighbours::around(BrickCoord brick) noexcept {
  const BrickCoord before{brick.x, brick.y, brick.z - 1};
  const bool follows = started_ && before == last_;
  last_ = brick;
  if (follows) {
    move_along_z(brick);
    return places_;
  }
  for (unsigned rows = static_cast<unsigned>(rows_); rows != 0; rows &= rows - 1) {
    const auto row = static_cast<std::size_t>(std::countr_zero(rows));
    const auto r = static_cast<std::int32_t>(row);
    BrickCoord at{brick.x + r / 3 - 1, brick.y + r % 3 - 1, brick.z - 1};
    std::size_t& place = row_[row];
    if (started_) {
      while (place < bricks_.size() && bricks_[place] < at) ++place;
    } else {
      place = static_cast<std::size_t>(std::lower_bound(bricks_.begin(), bricks_.end(), at) -
                                       bricks_.begin());
    }
    std::size_t next = place;
    for (std::size_t z = 0; z < 3; ++z, ++at.z) {
      const bool found = next < bricks_.size() && bricks_[next] == at;
      places_[row * 3 + z] = found ? static_cast<std::uint32_t>(next++) : kNoBrick;
    }
  }
  started_ = true;
  return places_;
}

}  // namespace tet
