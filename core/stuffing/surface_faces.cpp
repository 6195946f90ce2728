#include "core/stuffing/surface_faces.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "core/base/vector_clones.h"

namespace tet {
namespace {

/// Where the nodes behind some cells of a slice lie: in one brick of those around, whose slice
/// has them moved by some bits.
struct View {
  int y = 0, z = 0;         ///< the brick, from that of the cells
  int bits = 0;             ///< the node behind a cell's bit is so much higher
  std::uint64_t cells = 0;  ///< whose nodes lie there
};

/// Where the node behind a tet `+000` lies, from the tet's cell.
struct Behind {
  int x = 0;
  std::size_t view_count = 0;
  std::array<View, 4> view{};
};

constexpr View view_of(int dy, int dz, int brick_y, int brick_z) noexcept {
  View view{brick_y, brick_z, 8 * (dy - 8 * brick_y) + dz - 8 * brick_z, 0};
  for (int bit = 0; bit < 64; ++bit) {
    const int y = (bit >> 3) + dy - 8 * brick_y, z = (bit & 7) + dz - 8 * brick_z;
    if (y >= 0 && y < 8 && z >= 0 && z < 8) view.cells |= std::uint64_t{1} << bit;
  }
  return view;
}

/// By shape, and by which of its nodes is the `+`.
constexpr auto kBehind = [] {
  std::array<std::array<Behind, 4>, kTetShapes> all{};
  for (std::size_t s = 0; s < kTetShapes; ++s) {
    for (std::size_t k = 0; k < 4; ++k) {
      constexpr int kMiddle = 4;
      const Cell at(halo_index(kMiddle, kMiddle, kMiddle) + kMirrored[s][k]);
      Behind& behind = all[s][k];
      behind.x = at.x - kMiddle;
      for (int y = -1; y <= 1; ++y) {
        for (int z = -1; z <= 1; ++z) {
          const View view = view_of(at.y - kMiddle, at.z - kMiddle, y, z);
          if (view.cells != 0) behind.view[behind.view_count++] = view;
        }
      }
    }
  }
  return all;
}();

static_assert(std::ranges::all_of(kBehind, [](const auto& of_shape) {
  return std::ranges::all_of(of_shape, [](const Behind& b) { return b.x >= -2 && b.x <= 2; });
}));

/// The `+` nodes of the bricks around: by kind, and by a brick's y and z, the slices that lie
/// within two of the brick's own.
class SlicesAround {
 public:
  static constexpr int kFirst = 2;  ///< of the brick's own
  using Row = std::array<std::uint64_t, kFirst + 8 + 2>;

  explicit SlicesAround(const BrickSurroundings& around) noexcept {
    for (std::size_t b = 0; b < around.size(); ++b) {
      const std::size_t x = b / 9, yz = b % 9;
      for (std::size_t kind = 0; kind < kNodeKinds; ++kind) {
        enter(x, around[b] == nullptr ? kNone : around[b]->plus[kind], rows_[kind][yz]);
      }
    }
  }
  const Row& at(std::size_t kind, int y, int z) const noexcept {
    return rows_[kind][static_cast<std::size_t>(3 * (y + 1) + z + 1)];
  }

 private:
  static constexpr BrickMask kNone{};

  static void enter(std::size_t x, const BrickMask& plus, Row& row) noexcept {
    const auto& slice = plus.slice;
    if (x == 0) std::copy_n(slice.begin() + 6, 2, row.begin());
    if (x == 1) std::ranges::copy(slice, row.begin() + kFirst);
    if (x == 2) std::copy_n(slice.begin(), 2, row.begin() + kFirst + 8);
  }

  std::array<std::array<Row, 9>, kNodeKinds> rows_;
};

/// A brick's slices as one vector: of their loops of eight, compilers make eight of each.
using Slices [[gnu::vector_size(64)]] = std::uint64_t;

[[gnu::always_inline]] inline void load(const std::uint64_t* from, Slices& slices) noexcept {
  std::memcpy(&slices, from, sizeof slices);
}

[[gnu::always_inline]] inline void store(const Slices& slices, BrickMask& mask) noexcept {
  std::memcpy(mask.slice.data(), &slices, sizeof slices);
}

/// Finds, of one shape's tets `+000`, those whose face of zeros has no tet of the inside behind
/// it.
TET_VECTOR_CLONES
void find_open(const BrickMask& three_zeros,
               const CellNodes& inside,
               const SlicesAround& around,
               std::size_t number,
               TetsOnSurface& found) noexcept {
  const TetShape& shape = kTetShape[number];
  Slices all, tets{}, odd{}, high{};
  load(three_zeros.slice.data(), all);
  for (std::size_t plus = 0; plus < 4; ++plus) {
    const std::size_t kind = shape.kind[plus];
    const Behind& behind = kBehind[number][plus];
    Slices open;
    load(inside.plus[kind][node_around_cell(shape, plus)].slice.data(), open);
    open &= all;
    for (std::size_t v = 0; v < behind.view_count; ++v) {
      const View& view = behind.view[v];
      Slices seen;
      load(around.at(kind, view.y, view.z).data() + behind.x + SlicesAround::kFirst, seen);
      seen = seen << std::max(-view.bits, 0) >> std::max(view.bits, 0);
      open &= ~(seen & view.cells);
    }
    tets |= open;
    if ((plus & 1) != 0) odd |= open;
    if ((plus & 2) != 0) high |= open;
  }
  store(tets, found.tets);
  store(odd, found.plus_is_odd);
  store(high, found.plus_is_high);
}

/// Takes those out whose face lies at the domain's end.
void remove_at_end(const DomainFaces& domain, std::size_t shape, TetsOnSurface& open) noexcept {
  for_each_bit(open.tets, [&](int x, int y, int z) {
    const std::size_t plus = open.plus_node(static_cast<std::size_t>(x), 8 * y + z);
    if ((domain.behind_dents(shape, x, y, z) >> plus & 1) == 0) return;
    open.tets.slice[static_cast<std::size_t>(x)] &= ~(std::uint64_t{1} << (8 * y + z));
  });
}

}  // namespace

void find_on_surface(const ThreeZeros& three_zeros,
                     const CellNodes& inside,
                     const FacesAround& around,
                     SurfaceOfBrick& surface) noexcept {
  const SlicesAround slices(around.around);
  for (std::size_t shape = 0; shape < kTetShapes; ++shape) {
    find_open(three_zeros[shape], inside, slices, shape, surface[shape]);
    if (around.domain != nullptr) remove_at_end(*around.domain, shape, surface[shape]);
  }
}

FinestCounts count_finest_with_faces(const CellNodes& inside,
                                     const FacesAround& around,
                                     const FanMasks* fans) noexcept {
  ThreeZeros three_zeros;
  FinestCounts counts = count_finest_and_surface(inside, fans, three_zeros);
  SurfaceOfBrick surface;
  find_on_surface(three_zeros, inside, around, surface);
  for (const TetsOnSurface& of_shape : surface) counts.triangles += of_shape.tets.count();
  if (fans == nullptr) return counts;
  for (const BrickMask& fan : *fans) counts.triangles += 2 * std::uint64_t{fan.count()};  // 4
  return counts;
}

}  // namespace tet
