#include "core/pipeline/write_positions.h"

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

/// A row of eight lattice nodes along z.
template <class Real>
class NodeRow {
 public:
  NodeRow(const BrickFrame& frame, NodeKind kind) noexcept : frame_(frame), kind_(kind) {
    for (std::size_t z = 0; z < kRow; ++z) {
      const double pz = at(2, static_cast<int>(z));
      for (std::size_t r = 0; r < 3; ++r) along_z_[3 * z + r] = frame.row(r)[2] * pz;
    }
  }

  /// Writes all eight.
  void write(int x, int y, Real* out) const noexcept {
    const double px = at(0, x), py = at(1, y);
    std::array<double, 3 * kRow> base;
    for (std::size_t r = 0; r < 3; ++r) {
      const auto& row = frame_.row(r);
      base[r] = row[0] * px + row[1] * py;
    }
    for (std::size_t k = 3; k < base.size(); ++k) base[k] = base[k - 3];
    for (std::size_t k = 0; k < base.size(); ++k) {
      out[k] = static_cast<Real>(base[k] + along_z_[k]);
    }
  }

 private:
  double at(std::size_t axis, int cell) const noexcept {
    return frame_.corner()[axis] + frame_.edge() * (0.5 * (2 * cell + kind_));
  }

  const BrickFrame& frame_;
  NodeKind kind_;
  std::array<double, 3 * kRow> along_z_;
};

/// Nodes of one kind; `place` is that of the first zero one.
template <class Real>
inline Real* write_nodes(const BrickFrame& frame,
                         NodeKind kind,
                         const BrickMask& nodes,
                         const BrickMask& zero,
                         const OwnPlaces& places,
                         std::size_t place,
                         Real* out) noexcept {
  const NodeRow<Real> row(frame, kind);
  std::array<Real, 3 * kRow> all;
  for (int x = 0; x < 8; ++x) {
    std::uint64_t slice = nodes.slice[static_cast<std::size_t>(x)];
    std::uint64_t zero_slice = zero.slice[static_cast<std::size_t>(x)];
    for (int y = 0; y < 8; ++y, slice >>= 8, zero_slice >>= 8) {
      const std::uint64_t zeros = zero_slice & 0xff;
      std::uint64_t bits = slice & 0xff;
      if (bits == 0xff && zeros == 0) {
        row.write(x, y, out);
        out += all.size();
        continue;
      }
      if (bits != 0) row.write(x, y, all.data());
      for (; bits != 0; bits &= bits - 1) {
        const auto z = static_cast<std::size_t>(std::countr_zero(bits));
        if ((zeros >> z & 1) != 0) {
          const std::uint64_t lower = zeros & ((std::uint64_t{1} << z) - 1);
          const std::size_t i = place + static_cast<std::size_t>(std::popcount(lower));
          out = transform(frame, &places.x[i], &places.y[i], &places.z[i], 1, out);
        } else {
          for (std::size_t r = 0; r < 3; ++r) *out++ = all[3 * z + r];
        }
      }
      place += static_cast<std::size_t>(std::popcount(zeros));
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
  std::size_t place = 0;
  for (const NodeKind kind : {kCorner, kCentre}) {
    const BrickMask& zero = own.at_surface ? own.stuffed->zero[kind] : kNone;
    out = write_nodes(frame, kind, *own.node[kind], zero, places, place, out);
    place += zero.count();
  }
  if (!own.at_surface) return out;
  return transform(frame, &places.x[place], &places.y[place], &places.z[place],
                   places.count - place, out);
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
