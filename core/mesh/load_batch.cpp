#include "core/mesh/load_batch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <span>

#include "core/base/vector_clones.h"

namespace tet {
namespace {

/// A `Number` that need not be aligned.
template <class Number>
Number read(const std::byte* from) noexcept {
  Number number;
  std::memcpy(&number, from, sizeof(number));
  return number;
}

class FloatPositions {
 public:
  FloatPositions(std::span<const std::byte> bytes, const EdgeScale&) noexcept
      : first_(bytes.data()), last_(bytes.data() + bytes.size() - kStride) {}

  [[gnu::always_inline]] FloatRow edge(std::uint64_t a, std::uint64_t b) const noexcept {
    return row(b) - row(a);
  }

 private:
  static constexpr std::size_t kStride = 3 * sizeof(float);

  FloatRow row(std::uint64_t vertex) const noexcept {
    const std::byte* at = first_ + vertex * kStride;
    if (at != last_) return read<FloatRow>(at);  // with the next vertex's x, which nobody minds
    return FloatRow{read<float>(at), read<float>(at + 4), read<float>(at + 8), 0};
  }

  const std::byte *first_, *last_;
};

class DoublePositions {
 public:
  DoublePositions(std::span<const std::byte> bytes, const EdgeScale&) noexcept
      : first_(bytes.data()) {}

  [[gnu::always_inline]] FloatRow edge(std::uint64_t a, std::uint64_t b) const noexcept {
    const auto step = [&](std::uint64_t k) {
      return static_cast<float>(coordinate(b, k) - coordinate(a, k));
    };
    return FloatRow{step(0), step(1), step(2), 0};
  }

 private:
  double coordinate(std::uint64_t vertex, std::uint64_t k) const noexcept {
    return read<double>(first_ + (3 * vertex + k) * sizeof(double));
  }

  const std::byte* first_;
};

/// Positions whose edges are not fit to be measured as they are.
template <class Positions>
class Scaled {
 public:
  Scaled(std::span<const std::byte> bytes, const EdgeScale& scale) noexcept
      : positions_(bytes, scale), factor_(scale.factor()) {}

  [[gnu::always_inline]] FloatRow edge(std::uint64_t a, std::uint64_t b) const noexcept {
    return factor_ * positions_.edge(a, b);
  }

 private:
  Positions positions_;
  float factor_;
};

template <class Index, class Positions>
[[gnu::always_inline]] inline void load(const std::byte* tets,
                                        const Positions& positions,
                                        std::uint64_t first,
                                        std::uint64_t last,
                                        TetBatch& batch) noexcept {
  using Corners = std::array<Index, 4>;
  batch.load([&](std::size_t lane) {
    const std::uint64_t tet = std::min(first + lane, last);
    const auto [a, b, c, d] = read<Corners>(tets + tet * sizeof(Corners));
    return std::array{positions.edge(a, b), positions.edge(a, c), positions.edge(a, d)};
  });
}

// Rows become columns of eight: without instructions for as many that takes as long again as
// all that is measured. Each kind of positions has a function of its own, and what reads them
// is always inlined: where compilers left that to themselves, a kind took up to thirty times as
// long.
template <class Positions>
TET_VECTOR_CLONES void load_all(const MeshView& view,
                                std::uint64_t first,
                                std::uint64_t last,
                                const EdgeScale& scale,
                                TetBatch& batch) noexcept {
  const Positions positions(view.positions, scale);
  if (view.index_type == IndexType::kUint32) {
    load<std::uint32_t>(view.tets.data(), positions, first, last, batch);
  } else {
    load<std::uint64_t>(view.tets.data(), positions, first, last, batch);
  }
}

template <class Positions>
void load_scaled(const MeshView& view,
                 std::uint64_t first,
                 std::uint64_t last,
                 const EdgeScale& scale,
                 TetBatch& batch) noexcept {
  if (scale.factor() == 1) {
    load_all<Positions>(view, first, last, scale, batch);
  } else {
    load_all<Scaled<Positions>>(view, first, last, scale, batch);
  }
}

}  // namespace

EdgeScale::EdgeScale(double spacing) noexcept {
  constexpr int kMost = 120;  // both it and its inverse are floats
  constexpr int kFit = 12;  // fourth powers of edges that are so near 1 are far from any limit
  if (!(spacing > 0) || !std::isfinite(spacing)) return;
  const int exponent = std::clamp(std::ilogb(spacing), -kMost, kMost);
  if (std::abs(exponent) <= kFit) return;
  exponent_ = exponent;
  factor_ = std::ldexp(1.0F, -exponent_);
}

double EdgeScale::volume_of(double scaled) const noexcept {
  return std::ldexp(scaled, 3 * exponent_);
}

void load_batch(const MeshView& view,
                std::uint64_t first,
                std::size_t count,
                const EdgeScale& scale,
                TetBatch& batch) noexcept {
  const std::uint64_t last = first + count - 1;
  if (view.coordinate_type == CoordinateType::kFloat32) {
    load_scaled<FloatPositions>(view, first, last, scale, batch);
  } else {
    load_scaled<DoublePositions>(view, first, last, scale, batch);
  }
}

}  // namespace tet
