#include "core/plan/brick/write_positions.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "core/base/check.h"
#include "core/base/vec3.h"
#include "core/base/vector_clones.h"

// Parts of a clone, and compiled for its processor within it only.
#define TET_INLINE [[gnu::always_inline]] inline

namespace tet {
namespace {

constexpr std::size_t kRow = 8;

/// Stored coordinates of points in spacings from the brick's corner, as columns.
template <class Real>
TET_INLINE Real* transform(const BrickFrame& frame,
                           const double* x,
                           const double* y,
                           const double* z,
                           std::size_t count,
                           Real* out) noexcept {
  const auto [corner_x, corner_y, corner_z] = frame.corner();
  const std::array<std::array<double, 3>, 3> row{frame.row(0), frame.row(1), frame.row(2)};
  for (std::size_t i = 0; i < count; ++i) {
    const double px = corner_x + x[i], py = corner_y + y[i], pz = corner_z + z[i];
    for (std::size_t r = 0; r < 3; ++r) {
      out[3 * i + r] = static_cast<Real>(row[r][0] * px + row[r][1] * py + row[r][2] * pz);
    }
  }
  return out + 3 * count;
}

/// Slices of 8 x 8 lattice nodes.
template <class Real>
class NodeSlices {
 public:
  NodeSlices(const BrickFrame& frame, NodeKind kind) noexcept : frame_(frame), kind_(kind) {
    for (std::size_t z = 0; z < kRow; ++z) {
      for (std::size_t r = 0; r < 3; ++r) {
        along_z_[z][r] = frame.row(r)[2] * at(2, static_cast<int>(z));
      }
    }
  }

  void go_to(int x) noexcept {
    const double px = at(0, x);
    for (std::size_t y = 0; y < kRow; ++y) {
      const double py = at(1, static_cast<int>(y));
      for (std::size_t r = 0; r < 3; ++r) {
        start_[y][r] = frame_.row(r)[0] * px + frame_.row(r)[1] * py;
      }
    }
  }

  TET_INLINE Real* write(std::uint64_t nodes, Real* out) const noexcept {
    if (~nodes == 0) return write_all(out);
    for (; nodes != 0; nodes &= nodes - 1) {
      const auto bit = static_cast<std::size_t>(std::countr_zero(nodes));
      out = write_one(start_[bit / kRow], along_z_[bit % kRow], out);
    }
    return out;
  }

 private:
  double at(std::size_t axis, int cell) const noexcept {
    return frame_.corner()[axis] + frame_.edge() * (0.5 * (2 * cell + kind_));
  }
  TET_INLINE Real* write_all(Real* out) const noexcept {
    for (const Triple& start : start_) {
      for (std::size_t z = 0; z < kRow; ++z) out = write_one(start, along_z_[z], out);
    }
    return out;
  }
  TET_INLINE static Real* write_one(const Triple& start,
                                    const Triple& along,
                                    Real* out) noexcept {
    for (std::size_t r = 0; r < 3; ++r) out[r] = static_cast<Real>(start[r] + along[r]);
    return out + 3;
  }

  const BrickFrame& frame_;
  NodeKind kind_;
  std::array<Triple, kRow> along_z_, start_;
};

/// Nodes of one kind; `moved` has the stored coordinates of its zero ones.
template <class Real>
TET_INLINE Real* write_nodes(const BrickFrame& frame,
                             NodeKind kind,
                             const BrickMask& nodes,
                             const BrickMask& zero,
                             const Real* moved,
                             Real* out) noexcept {
  NodeSlices<Real> slices(frame, kind);
  for (std::size_t x = 0; x < 8; ++x) {
    const std::uint64_t slice = nodes.slice[x];
    if (slice != 0) slices.go_to(static_cast<int>(x));
    Real* const first = out;
    out = slices.write(slice, first);
    for (std::uint64_t bits = zero.slice[x]; bits != 0; bits &= bits - 1, moved += 3) {
      const std::uint64_t bit = bits & -bits;
      // Where both sides are meshed, zeros beyond the domain are no vertices.
      if ((slice & bit) != 0) {
        std::copy_n(moved, 3, first + std::ptrdiff_t{3} * std::popcount(slice & (bit - 1)));
      }
    }
  }
  return out;
}

template <class Real>
TET_INLINE Real* write_all(const BrickFrame& frame,
                           const OwnedVertices& own,
                           const OwnPlaces& places,
                           Real* out) noexcept {
  static constexpr BrickMask kNone;
  std::array<Real, std::size_t{3} * kNodeKinds * kBrickCells> moved;
  std::size_t zeros = 0;
  for (const NodeKind kind : {kCorner, kCentre}) {
    const BrickMask& zero = own.at_surface ? own.stuffed->zero[kind] : kNone;
    const std::size_t count = zero.count();
    transform(frame, &places.x[zeros], &places.y[zeros], &places.z[zeros], count, moved.data());
    out = write_nodes(frame, kind, *own.node[kind], zero, moved.data(), out);
    zeros += count;
  }
  if (!own.at_surface) return out;
  return transform(frame, &places.x[zeros], &places.y[zeros], &places.z[zeros],
                   places.count - zeros, out);
}

TET_VECTOR_CLONES
float* write_float32(const BrickFrame& frame,
                     const OwnedVertices& own,
                     const OwnPlaces& places,
                     float* out) noexcept {
  return write_all(frame, own, places, out);
}

TET_VECTOR_CLONES
double* write_float64(const BrickFrame& frame,
                      const OwnedVertices& own,
                      const OwnPlaces& places,
                      double* out) noexcept {
  return write_all(frame, own, places, out);
}

}  // namespace

BrickFrame::BrickFrame(const LatticeToWorld& to_world, BrickCoord brick, int level) noexcept
    : to_world_(to_world), edge_(std::ldexp(1.0, level)) {
  const VoxelCoord origin = to_world.origin;
  corner_ = {8 * edge_ * brick.x - origin.x, 8 * edge_ * brick.y - origin.y,
             8 * edge_ * brick.z - origin.z};
}

void write_positions(const BrickFrame& frame,
                     const OwnedVertices& own,
                     const OwnPlaces& places,
                     CoordinateType type,
                     std::span<std::byte> positions) noexcept {
  const void* end = nullptr;
  if (type == CoordinateType::kFloat32) {
    end = write_float32(frame, own, places, reinterpret_cast<float*>(positions.data()));
  } else {
    end = write_float64(frame, own, places, reinterpret_cast<double*>(positions.data()));
  }
  TET_CHECK(end == positions.data() + positions.size());
}

}  // namespace tet
