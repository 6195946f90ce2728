#include "core/stuffing/topology/climb.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "core/base/vector_clones.h"
#include "core/stuffing/topology/node_rows.h"

namespace tet {
namespace {

using internal::read, internal::Rows, internal::write;

/// Planes with none beyond either end, so that each has two before it and two behind. Rows
/// that are beyond a plane's first and last are its neighbours' last and first, which have no
/// nodes.
class PaddedPlanes {
 public:
  [[gnu::always_inline]] explicit PaddedPlanes(const NodePlanes& nodes) noexcept {
    Rows rows{};
    for (const std::size_t i : {0UL, 1UL, NodePlanes::kPlanes + 2, NodePlanes::kPlanes + 3})
      write(rows, plane_[i]);
    for (std::size_t i = 0; i < NodePlanes::kPlanes; ++i) {
      read(nodes.plane[i], rows);
      write(rows, plane_[i + 2]);
    }
  }
  /// Reads the rows that are `step` rows on from those of a plane.
  [[gnu::always_inline]] void read_at(std::size_t plane,
                                      int plane_step,
                                      int step,
                                      Rows& rows) const noexcept {
    const auto* const first = reinterpret_cast<const char*>(&plane_[plane + 2]);
    std::memcpy(&rows,
                first + plane_step * static_cast<int>(sizeof(NodePlane)) +
                    step * static_cast<int>(sizeof(rows[0])),
                sizeof(rows));
  }

 private:
  std::array<NodePlane, NodePlanes::kPlanes + 4> plane_;
};

/// How many steps it is, along y or z, from a node of a kind to the place of its neighbour on
/// a short edge that leads up (1) or down (-1) there.
constexpr int short_step(std::size_t kind, int up) noexcept {
  // A centre's corners are at its own place and one further on, a corner's centres one before.
  return kind == kCorner ? (up > 0 ? 0 : -1) : (up > 0 ? 1 : 0);
}

/// Moves what is some steps on along z to the node's own place.
[[gnu::always_inline]] inline void move_along_z(int step, Rows& rows) noexcept {
  rows = rows << (step < 0 ? 1 : 0) >> (step > 0 ? 1 : 0);
}

/// Finds the ends of the edges from a plane's nodes that lead nearer to the corner: those of a
/// place in seven directions, three of them long.
[[gnu::always_inline]] inline void find_nearer(const PaddedPlanes& nodes,
                                               std::size_t plane,
                                               const BoxCorner& corner,
                                               Rows& nearer) noexcept {
  const std::size_t kind = plane % 2;
  const int y_on = short_step(kind, corner.y), y_back = short_step(kind, -corner.y);
  const int z_on = short_step(kind, corner.z), z_back = short_step(kind, -corner.z);
  Rows rows, along_z, on, back;
  nodes.read_at(plane, 2 * corner.x, 0, nearer);
  nodes.read_at(plane, 0, corner.y, rows);
  nearer |= rows;
  nodes.read_at(plane, 0, 0, along_z);
  move_along_z(corner.z, along_z);
  nearer |= along_z;
  // Short edges lead nearer where at most one of their steps leads away.
  nodes.read_at(plane, corner.x, y_on, back);
  nodes.read_at(plane, -corner.x, y_on, on);
  on |= back;
  nodes.read_at(plane, corner.x, y_back, rows);
  on |= rows;
  move_along_z(z_on, on);
  move_along_z(z_back, back);
  nearer |= on | back;
}

using RowNumbers = std::array<std::uint16_t, sizeof(NodePlane) / sizeof(std::uint16_t)>;

int sum_of(const RowNumbers& lanes) noexcept {
  int sum = 0;
  for (const std::uint16_t lane : lanes) sum += lane;
  return sum;
}

/// How many nodes each row has at some places along z, in the lower and the upper half of the
/// planes.
struct RowCounts {
  RowNumbers lower_first, lower_last, upper_first, upper_last;
};

TET_VECTOR_CLONES
void count_rows(const NodePlanes& nodes, RowCounts& counts) noexcept {
  constexpr int kFirst = 2, kLast = 9;  // places of the brick's own nodes: z = 0 and 7
  const auto count = [&](std::size_t begin, RowNumbers & first, RowNumbers & last)
      __attribute__((always_inline)) {
    Rows at_first{}, at_last{};
    for (std::size_t i = begin; i < begin + NodePlanes::kPlanes / 2; ++i) {
      Rows rows;
      read(nodes.plane[i], rows);
      at_first += rows >> kFirst & 1;
      at_last += rows >> kLast & 1;
    }
    std::memcpy(first.data(), &at_first, sizeof(first));
    std::memcpy(last.data(), &at_last, sizeof(last));
  };
  count(0, counts.lower_first, counts.lower_last);
  count(NodePlanes::kPlanes / 2, counts.upper_first, counts.upper_last);
}

TET_VECTOR_CLONES
bool climb(const NodePlanes& nodes, const BoxCorner& corner) noexcept {
  const PaddedPlanes padded(nodes);
  // Nodes without one nearer: at a place of some plane, and of a second one.
  Rows ends{}, more{};
  for (std::size_t i = 0; i < NodePlanes::kPlanes; i += 2) {
    for (const std::size_t plane : {i, i + 1}) {
      Rows own, nearer;
      padded.read_at(plane, 0, 0, own);
      find_nearer(padded, plane, corner, nearer);
      own &= ~nearer;
      more |= ends & own;
      ends |= own;
    }
  }
  NodePlane one, two;
  write(ends, one);
  write(more, two);
  int count = 0;
  for (const std::uint64_t word : one.word) count += std::popcount(word);
  return count == 1 && two == NodePlane();
}

}  // namespace

BoxCorner corner_with_most(const NodePlanes& nodes) noexcept {
  RowCounts counts;
  count_rows(nodes, counts);
  const auto& [a, b, c, d] = counts;
  const auto more = [](int upper, int lower) { return upper >= lower ? 1 : -1; };
  int low_rows = 0, high_rows = 0;
  for (std::size_t low = 1; low <= 5; ++low) {
    low_rows += a[low] + b[low] + c[low] + d[low];
    const std::size_t high = 11 - low;
    high_rows += a[high] + b[high] + c[high] + d[high];
  }
  return {more(sum_of(c) + sum_of(d), sum_of(a) + sum_of(b)), more(high_rows, low_rows),
          more(sum_of(b) + sum_of(d), sum_of(a) + sum_of(c))};
}

BoxCorner corner_with_most(const BrickMask& nodes) noexcept {
  constexpr std::uint64_t kLowerRows = 0x00000000ffffffff, kLowerHalves = 0x0f0f0f0f0f0f0f0f;
  int all = 0, lower_x = 0, lower_y = 0, lower_z = 0;
  for (std::size_t x = 0; x < 8; ++x) {
    const std::uint64_t slice = nodes.slice[x];
    if (x == 4) lower_x = all;
    all += std::popcount(slice);
    lower_y += std::popcount(slice & kLowerRows);
    lower_z += std::popcount(slice & kLowerHalves);
  }
  const auto more = [&](int lower) { return 2 * lower <= all ? 1 : -1; };
  return {more(lower_x), more(lower_y), more(lower_z)};
}

bool all_climb_to_one(const NodePlanes& nodes, const BoxCorner& corner) noexcept {
  return climb(nodes, corner);
}

}  // namespace tet
