#include "core/pipeline/write_positions.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "core/base/check.h"
#include "core/base/vector_clones.h"

namespace tet {
namespace {

constexpr std::size_t kRow = 8;

/// Stored coordinates of points in spacings from the brick's corner, as columns.
template <class Real>
inline Real* transform(const BrickFrame& frame,
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

/// Rows of eight lattice nodes along z.
template <class Real>
class NodeRows {
 public:
  NodeRows(const BrickFrame& frame, NodeKind kind) noexcept : frame_(frame), kind_(kind) {
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t z = 0; z < kRow; ++z) {
        along_z_[r][z] = frame.row(r)[2] * at(2, static_cast<int>(z));
      }
    }
  }

  void go_to(int x, int y) noexcept {
    const double px = at(0, x), py = at(1, y);
    for (std::size_t r = 0; r < 3; ++r) {
      start_[r] = frame_.row(r)[0] * px + frame_.row(r)[1] * py;
    }
  }
  inline Real* write_all(Real* out) const noexcept {
    const auto [x, y, z] = start_;
    const auto& [along_x, along_y, along_z] = along_z_;
    for (std::size_t i = 0; i < kRow; ++i) {
      out[3 * i] = static_cast<Real>(x + along_x[i]);
      out[3 * i + 1] = static_cast<Real>(y + along_y[i]);
      out[3 * i + 2] = static_cast<Real>(z + along_z[i]);
    }
    return out + 3 * kRow;
  }
  Real* write_one(std::size_t z, Real* out) const noexcept {
    for (std::size_t r = 0; r < 3; ++r) *out++ = static_cast<Real>(start_[r] + along_z_[r][z]);
    return out;
  }

 private:
  double at(std::size_t axis, int cell) const noexcept {
    return frame_.corner()[axis] + frame_.edge() * (0.5 * (2 * cell + kind_));
  }

  const BrickFrame& frame_;
  NodeKind kind_;
  std::array<std::array<double, kRow>, 3> along_z_;
  std::array<double, 3> start_;
};

/// Nodes of one kind; `moved` has the stored coordinates of its zero ones.
template <class Real>
inline Real* write_nodes(const BrickFrame& frame,
                         NodeKind kind,
                         const BrickMask& nodes,
                         const BrickMask& zero,
                         const Real* moved,
                         Real* out) noexcept {
  NodeRows<Real> rows(frame, kind);
  for (int x = 0; x < 8; ++x) {
    std::uint64_t slice = nodes.slice[static_cast<std::size_t>(x)];
    std::uint64_t zero_slice = zero.slice[static_cast<std::size_t>(x)];
    for (int y = 0; (slice | zero_slice) != 0; ++y, slice >>= 8, zero_slice >>= 8) {
      const std::uint64_t row = slice & 0xff, zeros = zero_slice & 0xff;
      rows.go_to(x, y);
      if (row == 0xff && zeros == 0) {
        out = rows.write_all(out);
        continue;
      }
      for (std::uint64_t bits = row | zeros; bits != 0; bits &= bits - 1) {
        const auto z = static_cast<std::size_t>(std::countr_zero(bits));
        if ((zeros >> z & 1) == 0) {
          out = rows.write_one(z, out);
        } else {
          // Of both sides' zeros, those beyond the domain are no vertices.
          if ((row >> z & 1) != 0) out = std::copy_n(moved, 3, out);
          moved += 3;
        }
      }
    }
  }
  return out;
}

template <class Real>
inline Real* write_all(const BrickFrame& frame,
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
