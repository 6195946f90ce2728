#include "core/vdb/plain/plain_tree.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>
#include <type_traits>

#include "core/vdb/plain/unpack_chunk.h"
#include "core/vdb/walk/tree_type.h"
#include "core/vdb/walk/walk_tree.h"
#include "core/vdb/walk/walk_values.h"

namespace tet {
namespace {

constexpr std::int32_t kUpperEdge = 4096;
constexpr std::int32_t kLowerEdge = 128;

ValueFormat format_of(const GridOutline& grid) {
  return {*find_tree_type(grid.tree_type), grid.half_float, grid.compression};
}

/// Reads the arrays of values of one tree's nodes.
template <class T>
class ValueReader {
 public:
  explicit ValueReader(const GridOutline& grid)
      : format_(format_of(grid)), unpacker_(grid.compression) {}

  void set_background(T background) noexcept { background_ = background; }

  /// All values of a node, `active` or not, at `to`.
  template <int kLog2>
  void read(VdbCursor& cursor, const NodeMask<kLog2>& active, T* to);

 private:
  void read_array(VdbCursor& cursor, std::span<T> values);

  ValueFormat format_;
  RunUnpacker unpacker_;
  T background_{};
  std::vector<std::uint16_t> halves_;
  std::vector<T> stored_;
};

template <class T>
void ValueReader<T>::read_array(VdbCursor& cursor, std::span<T> values) {
  if (!format_.half_float) {
    return unpacker_.read(cursor, std::as_writable_bytes(values));
  }
  if (values.empty()) return;  // not even a length is written
  halves_.resize(values.size());
  unpacker_.read(cursor, std::as_writable_bytes(std::span(halves_)));
  std::ranges::transform(halves_, values.begin(), [](std::uint16_t half) {
    return static_cast<T>(half_to_float(half));
  });
}

/// Puts `stored` where `active` is set, one after another.
template <class T, int kLog2>
void spread(const NodeMask<kLog2>& active, const T* stored, T* to) {
  for (std::size_t i = 0; i < active.words.size(); ++i) {
    const std::uint64_t word = active.words[i];
    if (word == ~std::uint64_t{0}) {
      std::copy_n(stored, 64, to + i * 64);
      stored += 64;
      continue;
    }
    for (std::uint64_t rest = word; rest != 0; rest &= rest - 1) {
      to[i * 64 + static_cast<std::size_t>(std::countr_zero(rest))] = *stored++;
    }
  }
}

template <class T>
template <int kLog2>
void ValueReader<T>::read(VdbCursor& cursor, const NodeMask<kLog2>& active, T* to) {
  using Mask = NodeMask<kLog2>;
  const Inactive inactive = read_inactive(cursor, format_);
  T chosen = background_;
  T other = inactive == Inactive::kBackground ? background_ : -background_;
  if (count_stored(inactive) > 0) other = cursor.read<T>("inactive value");
  if (count_stored(inactive) > 1) chosen = cursor.read<T>("inactive value");
  Mask selected;
  if (has_mask(inactive)) {
    selected = Mask::from_bytes(cursor.take(Mask::kBytes, "selection mask"));
  }
  const std::uint32_t count = active.count();
  if (inactive == Inactive::kAllStored || count == Mask::kBits) {
    return read_array(cursor, {to, Mask::kBits});
  }
  stored_.resize(count);
  read_array(cursor, stored_);
  std::fill_n(to, Mask::kBits, other);
  selected.for_each([&](std::size_t bit) { to[bit] = chosen; });
  spread(active, stored_.data(), to);
}

template <class T>
class TreeReader {
 public:
  TreeReader(const ByteSource& source, const GridOutline& grid, Volume& volume)
      : cursor_(source), tree_(grid.tree), values_(grid), volume_(volume) {
    cursor_.move_to(grid.tree_at);
  }

  absl::StatusOr<std::vector<ConstantBrick>> read();

 private:
  void read_root_tile();
  void read_upper();
  void read_lower(const VoxelCoord& origin);
  void read_leaf(float* to);
  std::vector<std::size_t> order_leaves() const;

  /// Reads a node's masks and values; calls `visit(bit, value)` for each tile of another value
  /// than the background. Returns which children it has.
  template <int kLog2, class Visit>
  NodeMask<kLog2> read_node(std::vector<T>& values, const Visit& visit);

  VdbCursor cursor_;
  const TreeOutline& tree_;
  ValueReader<T> values_;
  Volume& volume_;
  std::vector<ConstantBrick> constants_;
  std::vector<BrickCoord> leaves_;  // in the file's order
  std::vector<T> upper_values_, lower_values_;
};

template <class T>
absl::StatusOr<std::vector<ConstantBrick>> TreeReader<T>::read() {
  cursor_.read<std::int32_t>("buffer count");
  const T background = cursor_.read<T>("background");
  values_.set_background(background);
  volume_.background = static_cast<float>(background);
  if (absl::Status s = check_background(volume_.background); !s.ok()) return s;
  const auto tiles = cursor_.read<std::uint32_t>("root tile count");
  const auto children = cursor_.read<std::uint32_t>("root child count");
  leaves_.reserve(tree_.leaves);
  for (std::uint32_t i = 0; i < tiles; ++i) read_root_tile();
  for (std::uint32_t i = 0; i < children; ++i) read_upper();

  const std::vector<std::size_t> place = order_leaves();
  volume_.bricks.resize(leaves_.size());
  volume_.values.resize(leaves_.size() * kBrickCells);
  for (std::size_t i = 0; i < leaves_.size(); ++i) {
    volume_.bricks[place[i]] = leaves_[i];
    read_leaf(&volume_.values[place[i] * kBrickCells]);
  }
  return std::move(constants_);
}

/// Where each leaf goes, as bricks are sorted.
template <class T>
std::vector<std::size_t> TreeReader<T>::order_leaves() const {
  std::vector<std::size_t> sorted(leaves_.size()), place(leaves_.size());
  std::iota(sorted.begin(), sorted.end(), std::size_t{0});
  std::ranges::sort(sorted,
                    [&](std::size_t a, std::size_t b) { return leaves_[a] < leaves_[b]; });
  for (std::size_t i = 0; i < sorted.size(); ++i) place[sorted[i]] = i;
  return place;
}

template <class T>
void TreeReader<T>::read_root_tile() {
  const auto origin = cursor_.read<VoxelCoord>("root origin");
  const auto value = static_cast<float>(cursor_.read<T>("root tile value"));
  cursor_.read<std::uint8_t>("root tile state");
  if (value != volume_.background) volume_.cubes.push_back({origin, kUpperEdge, value});
}

template <class T>
template <int kLog2, class Visit>
NodeMask<kLog2> TreeReader<T>::read_node(std::vector<T>& values, const Visit& visit) {
  using Mask = NodeMask<kLog2>;
  const Mask children = Mask::from_bytes(cursor_.take(Mask::kBytes, "child mask"));
  const Mask active = Mask::from_bytes(cursor_.take(Mask::kBytes, "value mask"));
  values.resize(Mask::kBits);
  values_.template read<kLog2>(cursor_, active, values.data());
  (~children).for_each([&](std::size_t bit) {
    const auto value = static_cast<float>(values[bit]);
    if (value != volume_.background) visit(bit, value);
  });
  return children;
}

template <class T>
void TreeReader<T>::read_upper() {
  const auto origin = cursor_.read<VoxelCoord>("root origin");
  const auto corner = [&](std::size_t bit) {
    const VoxelCoord c = UpperMask::place(bit);
    return VoxelCoord{origin.x + c.x * kLowerEdge, origin.y + c.y * kLowerEdge,
                      origin.z + c.z * kLowerEdge};
  };
  const UpperMask children = read_node<5>(upper_values_, [&](std::size_t bit, float value) {
    volume_.cubes.push_back({corner(bit), kLowerEdge, value});
  });
  children.for_each([&](std::size_t bit) { read_lower(corner(bit)); });
}

template <class T>
void TreeReader<T>::read_lower(const VoxelCoord& origin) {
  const auto brick = [&](std::size_t bit) {
    const VoxelCoord c = LowerMask::place(bit);
    return BrickCoord{(origin.x >> 3) + c.x, (origin.y >> 3) + c.y, (origin.z >> 3) + c.z};
  };
  const LowerMask children = read_node<4>(lower_values_, [&](std::size_t bit, float value) {
    constants_.push_back({brick(bit), value});
  });
  children.for_each([&](std::size_t bit) {
    leaves_.push_back(brick(bit));
    cursor_.skip(LeafMask::kBytes, "leaf mask");  // which its values repeat
  });
}

template <class T>
void TreeReader<T>::read_leaf(float* to) {
  const LeafMask active = LeafMask::from_bytes(cursor_.take(LeafMask::kBytes, "leaf mask"));
  if constexpr (std::is_same_v<T, float>) {
    values_.template read<3>(cursor_, active, to);
  } else {
    std::array<T, LeafMask::kBits> values;
    values_.template read<3>(cursor_, active, values.data());
    std::ranges::transform(values, to, [](T value) { return static_cast<float>(value); });
  }
}

bool is_double(const GridOutline& grid) { return grid.tree_type == "Tree_double_5_4_3"; }

/// What OpenVDB takes for equal.
bool nearly_equal(float a, float b) { return !(std::abs(a - b) > 1e-8F); }
bool nearly_equal(double a, double b) { return !(std::abs(a - b) > 1e-15); }

template <class T>
PlainRoot read_root(VdbCursor& cursor) {
  cursor.read<std::int32_t>("buffer count");
  const T background = cursor.read<T>("background");
  const auto tiles = cursor.read<std::uint32_t>("root tile count");
  PlainRoot root{static_cast<float>(background),
                 cursor.read<std::uint32_t>("root child count") == 0};
  for (std::uint32_t i = 0; i < tiles && root.empty; ++i) {
    cursor.read<VoxelCoord>("root origin");
    const T value = cursor.read<T>("root tile value");
    const bool active = cursor.read<std::uint8_t>("root tile state") != 0;
    root.empty = !active && nearly_equal(value, background);
  }
  return root;
}

}  // namespace

absl::StatusOr<std::vector<ConstantBrick>> read_plain_tree(const ByteSource& source,
                                                           const GridOutline& grid,
                                                           Volume& volume) {
  return is_double(grid) ? TreeReader<double>(source, grid, volume).read()
                         : TreeReader<float>(source, grid, volume).read();
}

PlainRoot read_plain_root(const ByteSource& source, const GridOutline& grid) {
  VdbCursor cursor(source);
  cursor.move_to(grid.tree_at);
  return is_double(grid) ? read_root<double>(cursor) : read_root<float>(cursor);
}

}  // namespace tet
