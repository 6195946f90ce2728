#include "core/fidelity/true_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "core/base/brick_mask.h"
#include "core/base/parallel.h"
#include "core/base/tet_geometry.h"
#include "core/field/world_phi.h"
#include "core/field/zero_along.h"

namespace tet {
namespace {

constexpr std::size_t kBricksPerRange = 16;
/// Where a triangle is looked at: the rule with the middles of its sides is exact for what
/// changes like a square, as the height of a surface above it does.
constexpr std::size_t kPointsPerPiece = 3;
constexpr std::size_t kMostPerBrick = 64;

/// A node of the lattice, and phi there.
struct Sample {
  Vector at;
  double phi = 0;
};

/// A flat piece of the surface, its normal pointing outside.
struct Piece {
  std::array<Vector, 3> corner;
  double steepness = 0;  ///< of phi across it, per unit of length
};

Vector operator+(const Vector& a, const Vector& b) noexcept {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
Vector operator*(double s, const Vector& a) noexcept { return {s * a.x, s * a.y, s * a.z}; }

Vector area_vector(const Piece& piece) noexcept {
  const auto& [a, b, c] = piece.corner;
  return 0.5 * cross(b - a, c - a);
}

Vector cut(const Sample& a, const Sample& b) noexcept {
  const double share = a.phi / (a.phi - b.phi);
  return a.at + share * (b.at - a.at);
}

/// The two samples of a tet's sides, inside first, and how many are inside.
struct SplitTet {
  std::array<Sample, 4> sample;
  std::size_t inside = 0;

  explicit SplitTet(const std::array<Sample, 4>& tet) noexcept {
    std::size_t at = 0;
    for (const Sample& s : tet) {
      if (s.phi < 0) sample[at++] = s;
    }
    inside = at;
    for (const Sample& s : tet) {
      if (!(s.phi < 0)) sample[at++] = s;
    }
  }
};

void add_piece(const SplitTet& tet,
               const std::array<Vector, 3>& corner,
               std::vector<Piece>& pieces) {
  Sample low{}, high{};
  for (std::size_t i = 0; i < 4; ++i) {
    const bool is_inside = i < tet.inside;
    const double share = 1.0 / static_cast<double>(is_inside ? tet.inside : 4 - tet.inside);
    Sample& side = is_inside ? low : high;
    side.at = side.at + share * tet.sample[i].at;
    side.phi += share * tet.sample[i].phi;
  }
  Piece piece{corner, 0};
  Vector normal = area_vector(piece);
  const Vector across = high.at - low.at;
  if (dot(normal, across) < 0) {
    std::swap(piece.corner[1], piece.corner[2]);
    normal = -1.0 * normal;
  }
  const double area = std::sqrt(dot(normal, normal));
  if (!(area > 0)) return;  // the surface passes through a node
  piece.steepness = (high.phi - low.phi) * area / dot(normal, across);
  pieces.push_back(piece);
}

void add_pieces(const SplitTet& tet, std::vector<Piece>& pieces) {
  const auto& s = tet.sample;
  if (tet.inside == 1) {
    add_piece(tet, {cut(s[0], s[1]), cut(s[0], s[2]), cut(s[0], s[3])}, pieces);
  } else if (tet.inside == 3) {
    add_piece(tet, {cut(s[0], s[3]), cut(s[1], s[3]), cut(s[2], s[3])}, pieces);
  } else if (tet.inside == 2) {
    const std::array quad{cut(s[0], s[2]), cut(s[0], s[3]), cut(s[1], s[3]), cut(s[1], s[2])};
    add_piece(tet, {quad[0], quad[1], quad[2]}, pieces);
    add_piece(tet, {quad[0], quad[2], quad[3]}, pieces);
  }
}

/// Six tets around the diagonal of a cell, by its corners at 4x + 2y + z: neighbours split
/// their shared faces alike.
constexpr std::array<std::array<std::size_t, 4>, 6> kTetsOfCell{
    {{0, 4, 6, 7}, {0, 6, 2, 7}, {0, 2, 3, 7}, {0, 3, 1, 7}, {0, 1, 5, 7}, {0, 5, 4, 7}}};

void add_cell(const std::array<Sample, 8>& corner, std::vector<Piece>& pieces) {
  for (const auto& [a, b, c, d] : kTetsOfCell) {
    add_pieces(SplitTet({corner[a], corner[b], corner[c], corner[d]}), pieces);
  }
}

/// What one brick adds.
struct BrickShare {
  double area = 0, volume = 0;
  double sampled_area = 0, beyond = 0;  ///< of pieces that were looked at: volume beyond them
};

/// Finds the surface brick by brick.
class BrickSurface {
 public:
  explicit BrickSurface(const PhiField& field)
      : sampler_(field),
        transform_(field.lattice_transform()),
        phi_(field, kStep * transform_.voxel_size),
        samples_(std::make_unique<BrickSamples>()) {}

  /// Adds the points of `most` pieces at most.
  BrickShare find(BrickCoord brick,
                  const WorldPoint& origin,
                  std::size_t most,
                  std::vector<SurfacePoint>& points) {
    gather(brick, origin);
    BrickShare share;
    for (const Piece& piece : pieces_) {
      const Vector area = area_vector(piece);
      share.area += std::sqrt(dot(area, area));
      share.volume += dot(piece.corner[0], area) / 3;
    }
    const std::size_t sampled = std::min(most, pieces_.size());
    const std::size_t first = points.size();
    for (std::size_t i = 0; i < sampled; ++i) {
      look_at(pieces_[i * pieces_.size() / sampled], origin, share, points);
    }
    if (!(share.sampled_area > 0)) return share;
    // The pieces that were looked at stand for all of the brick.
    const double scale = share.area / share.sampled_area;
    for (std::size_t i = first; i < points.size(); ++i) points[i].area *= scale;
    share.beyond *= scale;
    return share;
  }

 private:
  /// What slopes are measured over, in spacings.
  static constexpr double kStep = 1e-4;
  /// How far the surface is from a flat piece of it, in spacings.
  static constexpr double kReach = 1;
  static constexpr double kClose = 1e-7;

  void gather(BrickCoord brick, const WorldPoint& origin) {
    sampler_.sample(brick, *samples_);
    pieces_.clear();
    for (int x = 0; x < kBrickEdge; ++x) {
      for (int y = 0; y < kBrickEdge; ++y) {
        for (int z = 0; z < kBrickEdge; ++z) {
          if (!is_cut(x, y, z)) continue;
          std::array<Sample, 8> corner;
          for (int i = 0; i < 8; ++i) {
            corner[static_cast<std::size_t>(i)] =
                sample_at(brick, x + (i >> 2), y + (i >> 1 & 1), z + (i & 1), origin);
          }
          add_cell(corner, pieces_);
        }
      }
    }
  }

  double phi_at(int x, int y, int z) const noexcept {
    return static_cast<double>(samples_->corner[static_cast<std::size_t>(halo_index(x, y, z))]);
  }

  /// Whether the corners of a cell lie on both sides.
  bool is_cut(int x, int y, int z) const noexcept {
    int inside = 0;
    for (int i = 0; i < 8; ++i) {
      inside += phi_at(x + (i >> 2), y + (i >> 1 & 1), z + (i & 1)) < 0 ? 1 : 0;
    }
    return inside > 0 && inside < 8;
  }

  Sample sample_at(
      BrickCoord brick, int x, int y, int z, const WorldPoint& origin) const noexcept {
    const WorldPoint at =
        transform_.to_world({8.0 * brick.x + x, 8.0 * brick.y + y, 8.0 * brick.z + z});
    return {from_to(origin, at), phi_at(x, y, z)};
  }

  void look_at(const Piece& piece,
               const WorldPoint& origin,
               BrickShare& share,
               std::vector<SurfacePoint>& points) {
    const Vector normal = area_vector(piece);
    const double area = std::sqrt(dot(normal, normal));
    const double part = area / kPointsPerPiece;
    share.sampled_area += area;
    for (std::size_t i = 0; i < kPointsPerPiece; ++i) {
      const Vector middle = 0.5 * (piece.corner[i] + piece.corner[(i + 1) % 3]);
      const WorldPoint start{origin.x + middle.x, origin.y + middle.y, origin.z + middle.z};
      const auto height = height_above(start, (1 / area) * normal, piece.steepness);
      if (!height) continue;
      share.beyond += part * *height;
      const Vector up = (*height / area) * normal;
      points.push_back({{start.x + up.x, start.y + up.y, start.z + up.z}, part});
    }
  }

  /// How far along `normal` from `start` phi is zero: nothing where it is not within reach.
  std::optional<double> height_above(const WorldPoint& start,
                                     const Vector& normal,
                                     double steepness) noexcept {
    const auto phi_at = [&](double t) {
      return phi_.at({start.x + t * normal.x, start.y + t * normal.y, start.z + t * normal.z});
    };
    const double spacing = transform_.voxel_size;
    return zero_along(phi_at, steepness, {kReach * spacing, kClose * spacing});
  }

  PhiSampler sampler_;
  VoxelTransform transform_;  ///< of the lattice
  WorldPhi phi_;
  std::unique_ptr<BrickSamples> samples_;
  std::vector<Piece> pieces_;
};

/// What a run of bricks adds.
struct RunShare {
  BrickShare sums;
  std::vector<SurfacePoint> points;
};

/// The bricks that count.
std::vector<BrickCoord> within(const std::vector<BrickCoord>& bricks,
                               const std::optional<BrickBox>& domain) {
  std::vector<BrickCoord> kept = bricks;
  if (!domain) return kept;
  const BrickCoord &min = domain->min, &max = domain->max;
  std::erase_if(kept, [&](const BrickCoord& b) {
    return b.x < min.x || b.y < min.y || b.z < min.z || b.x > max.x || b.y > max.y ||
           b.z > max.z;
  });
  return kept;
}

TrueSurface sum_of(std::vector<RunShare>& runs) {
  TrueSurface surface;
  BrickShare sums;
  double sampled = 0;
  for (RunShare& run : runs) {
    sums.area += run.sums.area;
    sums.volume += run.sums.volume;
    sums.beyond += run.sums.beyond;
    for (const SurfacePoint& point : run.points) sampled += point.area;
    surface.points.insert(surface.points.end(), run.points.begin(), run.points.end());
  }
  surface.area = sums.area;
  // Bricks that were looked at stand for those that were not.
  const double scale = sampled > 0 ? sums.area / sampled : 0;
  for (SurfacePoint& point : surface.points) point.area *= scale;
  surface.enclosed_volume = sums.volume + scale * sums.beyond;
  return surface;
}

}  // namespace

absl::StatusOr<TrueSurface> find_true_surface(const PhiField& field,
                                              const std::vector<BrickCoord>& all_bricks,
                                              const std::optional<BrickBox>& domain,
                                              std::size_t most_points,
                                              const Cancellation& cancellation) {
  const std::vector<BrickCoord> bricks = within(all_bricks, domain);
  if (bricks.empty()) return TrueSurface{};
  const VoxelTransform lattice = field.lattice_transform();
  const BrickCoord& middle = bricks[bricks.size() / 2];
  const WorldPoint origin = lattice.to_world({8.0 * middle.x, 8.0 * middle.y, 8.0 * middle.z});
  const std::size_t most_pieces = std::max<std::size_t>(1, most_points / kPointsPerPiece);
  const std::size_t every = (bricks.size() + most_pieces - 1) / most_pieces;
  const std::size_t per_brick =
      std::clamp<std::size_t>(most_pieces * every / bricks.size(), 1, kMostPerBrick);

  std::vector<RunShare> runs((bricks.size() + kBricksPerRange - 1) / kBricksPerRange);
  for_each_index(runs.size(), [&](std::size_t r) {
    BrickSurface surface(field);
    const std::size_t end = std::min(bricks.size(), (r + 1) * kBricksPerRange);
    for (std::size_t i = r * kBricksPerRange; i < end; ++i) {
      if (cancellation.requested()) return;
      const std::size_t most = i % every == 0 ? per_brick : 0;
      const BrickShare share = surface.find(bricks[i], origin, most, runs[r].points);
      runs[r].sums.area += share.area;
      runs[r].sums.volume += share.volume;
      runs[r].sums.beyond += share.beyond;
    }
  });
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  return sum_of(runs);
}

}  // namespace tet
