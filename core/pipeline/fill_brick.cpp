#include "core/pipeline/fill_brick.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <utility>

#include "core/base/check.h"
#include "core/stuffing/cut_tet.h"

namespace tet {
namespace {

/// Statistics of one tet of each background shape on a lattice of spacing 1.
struct BackgroundShapes {
  QualityStats bcc, bisected, quadrisected, half_pyramid;
  QualityStats halved, in_three;  ///< the two, and the three, tets of a half pyramid
};

using TetPoints = std::array<WorldPoint, 4>;

QualityStats stats_of(std::initializer_list<TetPoints> tets) {
  QualityMeter meter;
  for (const auto& [a, b, c, d] : tets) meter.add_tet(a, b, c, d);
  return meter.stats();
}

const BackgroundShapes& background_shapes() {
  // Cell [0, 1]^3 with its upper face across x, seen from the centre.
  constexpr WorldPoint kLow{0.5, 0.5, 0.5}, kHigh{1.5, 0.5, 0.5};
  constexpr WorldPoint kFace{1, 0.5, 0.5}, kMiddle{1, 0.5, 0};
  constexpr WorldPoint kCorner0{1, 0, 0}, kCorner1{1, 1, 0}, kCorner2{1, 1, 1};
  constexpr WorldPoint kNext{1, 1, 0.5};  // between corners 1 and 2
  const auto tet = [&](WorldPoint a, WorldPoint b, WorldPoint c) {
    return TetPoints{kLow, a, b, c};
  };
  static const BackgroundShapes shapes{
      .bcc = stats_of({tet(kHigh, kCorner0, kCorner1)}),
      .bisected = stats_of({tet(kHigh, kCorner0, kMiddle)}),
      .quadrisected = stats_of({tet(kFace, kCorner0, kMiddle)}),
      .half_pyramid = stats_of({tet(kCorner0, kCorner1, kCorner2)}),
      .halved = stats_of({tet(kCorner0, kMiddle, kCorner2), tet(kMiddle, kCorner1, kCorner2)}),
      .in_three = stats_of({tet(kMiddle, kCorner1, kNext), tet(kCorner0, kMiddle, kNext),
                            tet(kCorner0, kNext, kCorner2)})};
  return shapes;
}

double determinant(const std::array<std::array<double, 3>, 3>& m) noexcept {
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
         m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

/// Writes stored positions one after another.
template <class Real>
class PositionWriter {
 public:
  PositionWriter(const LatticeToWorld& to_world, std::span<std::byte> bytes)
      : to_world_(to_world), out_(reinterpret_cast<Real*>(bytes.data())) {}

  /// `place` in units of the spacing from lattice corner (x, y, z).
  void write(double x, double y, double z, const WorldPoint& place) noexcept {
    // Whole lattice distances first: they are exact, however far away the grid lies.
    const double px = x - to_world_.origin.x + place.x;
    const double py = y - to_world_.origin.y + place.y;
    const double pz = z - to_world_.origin.z + place.z;
    for (const auto& row : to_world_.linear) {
      *out_++ = static_cast<Real>(row[0] * px + row[1] * py + row[2] * pz);
    }
  }

  const Real* end() const noexcept { return out_; }

 private:
  const LatticeToWorld& to_world_;
  Real* out_;
};

/// Vertices in the middle of surface quads; (x, y, z) is the brick's lowest corner.
template <class Real>
void write_fans(const FanMasks& fans,
                const StuffedLattice& lattice,
                double x,
                double y,
                double z,
                PositionWriter<Real>& writer) noexcept {
  for (std::size_t shape = 0; shape < kTetShapes; ++shape) {
    for_each_bit(fans[shape], [&](int i, int j, int k) {
      writer.write(x, y, z, middle_of_quad(kTetShape[shape], halo_index(i, j, k), lattice));
    });
  }
}

}  // namespace

void BrickFiller::fill(std::size_t brick, const ChunkColumns& columns) noexcept {
  const BrickPlace place = mesh_.place(brick);
  lattice_ = nullptr;
  if (place.level == 0 && mesh_.touches_surface(place.brick)) {
    if (!mesh_.unpack_lattice(place.brick, workspace_.stuffing.lattice)) {
      stuff_brick(sampler_, mesh_.tree().levels[0].bricks[place.brick], mesh_.rules(),
                  mesh_.restored(), workspace_.stuffing);
    }
    lattice_ = &workspace_.stuffing.lattice;
  }
  if (header_.coordinate_type == CoordinateType::kFloat32) {
    fill_positions<float>(place, columns.positions);
  } else {
    fill_positions<double>(place, columns.positions);
  }
  if (header_.index_type == IndexType::kUint32) {
    fill_tets<std::uint32_t>(place, columns.tets, columns.regions);
  } else {
    fill_tets<std::uint64_t>(place, columns.tets, columns.regions);
  }
}

template <class Real>
void BrickFiller::fill_positions(BrickPlace place, std::span<std::byte> bytes) noexcept {
  PositionWriter<Real> writer(to_world_, bytes);
  const OctreeLevel& level = mesh_.tree().levels[static_cast<std::size_t>(place.level)];
  const LevelNodes& nodes = mesh_.nodes(place.level);
  const BrickCoord brick = level.bricks[place.brick];
  const double edge = std::ldexp(1.0, place.level);  // of a cell, in spacings
  const double x = 8 * edge * brick.x, y = 8 * edge * brick.y, z = 8 * edge * brick.z;
  for (const NodeKind kind : {kCorner, kCentre}) {
    const auto& owned = kind == kCorner ? nodes.corner : nodes.centre;
    for_each_bit(owned[place.brick], [&](int i, int j, int k) {
      const int index = halo_index(i, j, k);
      if (lattice_ != nullptr) {
        writer.write(x, y, z, lattice_->place_of_node(kind, index));
      } else {
        const WorldPoint at = lattice_place(kind, index);
        writer.write(x, y, z, {edge * at.x, edge * at.y, edge * at.z});
      }
    });
  }
  if (lattice_ != nullptr) {
    const OwnedVertices own = mesh_.finest_vertices_at(brick);
    for (int family = 0; family < kEdgeFamilies; ++family) {
      for_each_bit((*own.cut)[static_cast<std::size_t>(family)], [&](int i, int j, int k) {
        writer.write(x, y, z, lattice_->place_of_cut(family, halo_index(i, j, k)));
      });
    }
    if (own.fans != nullptr) write_fans(*own.fans, *lattice_, x, y, z, writer);
  }
  TET_CHECK(reinterpret_cast<const std::byte*>(writer.end()) == bytes.data() + bytes.size());
}

template <>
FinestIds<std::uint32_t>& BrickFiller::ids() noexcept {
  return workspace_.ids32;
}

template <>
FinestIds<std::uint64_t>& BrickFiller::ids() noexcept {
  if (!workspace_.ids64) workspace_.ids64 = std::make_unique<FinestIds<std::uint64_t>>();
  return *workspace_.ids64;
}

template <class Index>
void BrickFiller::fill_tets(BrickPlace place,
                            std::span<std::byte> bytes,
                            std::span<std::byte> regions) noexcept {
  if (bytes.empty()) return;
  auto* const begin = reinterpret_cast<Index*>(bytes.data());
  Index* end = begin;
  if (place.level == 0) {
    number_finest(mesh_.tree().levels[0].bricks[place.brick], ids<Index>());
  }
  for (const MeshRegion region : mesh_.regions()) {
    Index* const first = end;
    end = place.level == 0 ? fill_finest_tets(place.brick, ids<Index>(), region, first)
                           : fill_background_tets(place, region, first);
    if (regions.empty()) continue;
    const auto tets = static_cast<std::size_t>(end - first) / 4;
    std::fill_n(regions.begin(), tets, static_cast<std::byte>(region));
    regions = regions.subspan(tets);
  }
  TET_CHECK(reinterpret_cast<std::byte*>(end) == bytes.data() + bytes.size());
  if (!to_world_.mirrors) return;
  for (Index* tet = begin; tet != end; tet += 4) std::swap(tet[2], tet[3]);
}

template <class Index>
void BrickFiller::number_finest(BrickCoord brick, FinestIds<Index>& ids) noexcept {
  for (int o = 0; o < 8; ++o) {
    const int x = o >> 2, y = o >> 1 & 1, z = o & 1;
    number_vertices(mesh_.finest_vertices_at({brick.x + x, brick.y + y, brick.z + z}), x, y, z,
                    ids);
  }
}

template <class Index>
Index* BrickFiller::fill_finest_tets(std::size_t brick,
                                     const FinestIds<Index>& ids,
                                     MeshRegion region,
                                     Index* out) noexcept {
  const OctreeLevel& level = mesh_.tree().levels[0];
  const BrickCoord b = level.bricks[brick];
  FinestNodes nodes =
      gather_nodes(mesh_.neighbourhood(brick), gather_halo(level, level.leaf, b));
  if (region == MeshRegion::kOutside) nodes = seen_from_outside(nodes);
  const OwnedVertices own = mesh_.finest_vertices_at(b);
  BackgroundCounts counts;
  out = fill_finest({nodes, own, lattice_, mesh_.rules()}, ids, out, meter_, counts);
  count_background_quality(counts, 0);
  return out;
}

template <class Index>
Index* BrickFiller::fill_background_tets(BrickPlace place,
                                         MeshRegion region,
                                         Index* out) noexcept {
  const OctreeLevel& level = mesh_.tree().levels[static_cast<std::size_t>(place.level)];
  const BrickCoord brick = level.bricks[place.brick];
  const BackgroundCells cells = gather_background(level, brick, region);
  count_background_quality(count_background(cells), place.level);
  return fill_background(cells, mesh_.numbers(), place.level, brick, out);
}

void BrickFiller::count_background_quality(const BackgroundCounts& counts, int level) noexcept {
  const BackgroundShapes& shapes = background_shapes();
  const double scale = std::ldexp(1.0, 3 * level);
  background_.add_copies(shapes.bcc, counts.bcc, scale);
  background_.add_copies(shapes.bisected, counts.bisected, scale);
  background_.add_copies(shapes.quadrisected, counts.quadrisected, scale);
  background_.add_copies(shapes.half_pyramid, counts.half_pyramid, scale);
  background_.add_copies(shapes.halved, counts.halved, scale);
  background_.add_copies(shapes.in_three, counts.in_three, scale);
}

QualityStats BrickFiller::stats() const noexcept {
  QualityStats stats = meter_.stats();
  stats.add(background_);
  stats.volume *= std::abs(determinant(to_world_.linear));
  return stats;
}

MeshWorkspace::MeshWorkspace() : impl_(std::make_unique<Impl>()) {}
MeshWorkspace::~MeshWorkspace() = default;
MeshWorkspace::MeshWorkspace(MeshWorkspace&&) noexcept = default;
MeshWorkspace& MeshWorkspace::operator=(MeshWorkspace&&) noexcept = default;

}  // namespace tet
