#include "core/field/find_scene_bricks.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/parallel.h"
#include "core/field/domain.h"
#include "core/scene/scene_evaluator.h"

namespace tet {
namespace {

constexpr int kParts = 4;  // along each axis
constexpr int kHalo = 2;   // cells around a brick that its own depend on

/// What bounds say of a cube.
enum class Side : std::uint8_t { kOutside, kInside, kBoth };

/// A cube of space, cells: [min, min + edge]^3 from its lowest corner on.
struct CellCube {
  double x = 0, y = 0, z = 0, edge = 0;
};

/// Cubes of `edge` bricks, a power of kParts, by their lowest brick.
struct CubeLevel {
  std::int32_t edge = 1;
  std::vector<BrickCoord> cubes;
};

/// The bricks of a cube and the halo around them.
CellCube with_halo(BrickCoord min, std::int32_t edge) {
  return {8.0 * min.x - kHalo, 8.0 * min.y - kHalo, 8.0 * min.z - kHalo,
          8.0 * edge + 2 * kHalo};
}

/// Looks at cubes by their parts.
class CubeScan {
 public:
  CubeScan(const PhiField& field, const Cancellation& cancellation)
      : evaluator_(*field.scene), spacing_(field.spacing_voxels) {
    evaluator_.stop_when(cancellation);
  }

  /// Where the parts of a cube of bricks lie, each with its halo; at 16*x + 4*y + z.
  std::array<Side, 64> parts_of(BrickCoord min, std::int32_t edge) {
    const std::int32_t part = edge / kParts;
    return sides(with_halo(min, edge), 8.0 * part, 8.0 * part + 2 * kHalo);
  }

  /// Where a brick and its halo lie.
  Side side_of(BrickCoord brick) {
    const CellCube all = with_halo(brick, 1);
    const double part = all.edge / kParts;
    const auto found = sides(all, part, part);
    // Between parts of both signs there is one that has both.
    const bool both =
        std::any_of(found.begin(), found.end(), [](Side side) { return side == Side::kBoth; });
    return both ? Side::kBoth : found[0];
  }

 private:
  /// Tells on which side each of 4^3 parts lies. Parts have edges of `part_edge` cells, are
  /// `step` apart, and begin where `all` begins.
  std::array<Side, 64> sides(const CellCube& all, double step, double part_edge) {
    const double half = 0.5 * all.edge;
    evaluator_.focus(
        {spacing_ * (all.x + half), spacing_ * (all.y + half), spacing_ * (all.z + half)},
        spacing_ * half);
    const auto middle = [&](double min, int i) {
      return spacing_ * (min + i * step + 0.5 * part_edge);
    };
    for (int i = 0; i < 64; ++i) {
      const auto at = static_cast<std::size_t>(i);
      points_.x[at] = middle(all.x, i / 16);
      points_.y[at] = middle(all.y, i / 4 % 4);
      points_.z[at] = middle(all.z, i % 4);
    }
    const auto& [low, high] = evaluator_.bounds(points_, 64, spacing_ * 0.5 * part_edge);
    std::array<Side, 64> found{};
    for (std::size_t i = 0; i < 64; ++i) {
      found[i] = low.at[i] > 0 ? Side::kOutside : high.at[i] < 0 ? Side::kInside : Side::kBoth;
    }
    return found;
  }

  SceneEvaluator evaluator_;
  scene::Points points_{};
  double spacing_;
};

bool meet(BrickCoord min, std::int32_t edge, const BrickBox& box) {
  return min.x <= box.max.x && min.y <= box.max.y && min.z <= box.max.z &&
         min.x + edge > box.min.x && min.y + edge > box.min.y && min.z + edge > box.min.z;
}

BrickBox box_of(BrickCoord min, std::int32_t edge) {
  return {min, {min.x + edge - 1, min.y + edge - 1, min.z + edge - 1}};
}

/// At most 64 cubes that cover a box.
CubeLevel covering(const BrickBox& box) {
  const auto count = [&](std::int32_t edge) {
    const auto along = [&](std::int32_t min, std::int32_t max) {
      return (max - min) / edge + 1;
    };
    return 1.0 * along(box.min.x, box.max.x) * along(box.min.y, box.max.y) *
           along(box.min.z, box.max.z);
  };
  CubeLevel level;
  while (count(level.edge) > 64) level.edge *= kParts;
  for (std::int32_t x = box.min.x; x <= box.max.x; x += level.edge) {
    for (std::int32_t y = box.min.y; y <= box.max.y; y += level.edge) {
      for (std::int32_t z = box.min.z; z <= box.max.z; z += level.edge) {
        level.cubes.push_back({x, y, z});
      }
    }
  }
  return level;
}

/// What was found in a few cubes.
struct CubeFindings {
  std::vector<BrickCoord> to_look_into;
  std::vector<BrickBox> inside;
};

void look_into(CubeScan& scan,
               BrickCoord min,
               std::int32_t edge,
               const BrickBox& within,
               CubeFindings& found) {
  const auto sides = scan.parts_of(min, edge);
  const std::int32_t part = edge / kParts;
  for (int i = 0; i < 64; ++i) {
    const BrickCoord at{min.x + i / 16 * part, min.y + i / 4 % 4 * part, min.z + i % 4 * part};
    const Side side = sides[static_cast<std::size_t>(i)];
    if (side == Side::kOutside || !meet(at, part, within)) continue;
    if (side == Side::kInside) found.inside.push_back(box_of(at, part));
    if (side == Side::kBoth) found.to_look_into.push_back(at);
  }
}

/// Bricks that the surface may meet in a level's cubes: about edge^2 in each.
double bricks_of_surface(const CubeLevel& level) {
  return static_cast<double>(level.cubes.size()) * level.edge * level.edge;
}

/// Refuses early what is going to be too much. Where the surface is small in its cubes the
/// guess is high, most so for a few spacings in a large cube: hence the slack.
absl::Status check_cubes(const CubeLevel& level, std::size_t most) {
  const double bricks = bricks_of_surface(level);
  const double slack = level.edge == 1 ? 1 : 2.0 * level.edge;
  return check_surface_bricks(bricks / slack, most).ok() ? absl::OkStatus()
                                                         : check_surface_bricks(bricks, most);
}

/// The next finer level; adds what lies inside. Gives up when there is more than can be kept.
absl::StatusOr<CubeLevel> refine(const PhiField& field,
                                 const CubeLevel& level,
                                 const BrickBox& within,
                                 std::size_t most,
                                 const Cancellation& cancellation,
                                 FoundBricks& found) {
  constexpr std::size_t kCubesOfGroup = 32;
  const std::size_t cubes = level.cubes.size();
  std::vector<CubeFindings> findings((cubes + kCubesOfGroup - 1) / kCubesOfGroup);
  std::atomic<std::size_t> kept = 0;
  const auto too_many = [&] {
    return !check_surface_bricks(static_cast<double>(kept), most).ok();
  };
  for_each_index(findings.size(), [&](std::size_t group) {
    if (cancellation.requested() || too_many()) return;
    CubeScan scan(field, cancellation);
    const std::size_t begin = group * kCubesOfGroup;
    const std::size_t end = std::min(begin + kCubesOfGroup, cubes);
    for (std::size_t i = begin; i < end && !cancellation.requested(); ++i) {
      look_into(scan, level.cubes[i], level.edge, within, findings[group]);
    }
    kept += findings[group].to_look_into.size();
  });
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  // How many there were when it gave up depends on the threads; what was expected does not.
  if (too_many()) {
    const absl::Status status = check_surface_bricks(bricks_of_surface(level), most);
    return status.ok() ? check_surface_bricks(64.0 * static_cast<double>(cubes), most) : status;
  }
  CubeLevel finer{level.edge / kParts, {}};
  for (const CubeFindings& one : findings) {
    finer.cubes.insert(finer.cubes.end(), one.to_look_into.begin(), one.to_look_into.end());
    found.inside.insert(found.inside.end(), one.inside.begin(), one.inside.end());
  }
  return finer;
}

/// The last step: bricks, each by parts of itself.
absl::Status sort_bricks(const PhiField& field,
                         const CubeLevel& bricks,
                         const Cancellation& cancellation,
                         FoundBricks& found) {
  std::vector<Side> sides(bricks.cubes.size());
  for_each_range(sides.size(), 64, [&](std::size_t begin, std::size_t end) {
    CubeScan scan(field, cancellation);
    for (std::size_t i = begin; i < end && !cancellation.requested(); ++i) {
      sides[i] = scan.side_of(bricks.cubes[i]);
    }
  });
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (sides[i] == Side::kOutside) continue;
    if (sides[i] == Side::kBoth) found.near_surface.push_back(bricks.cubes[i]);
    found.inside.push_back(box_of(bricks.cubes[i], 1));
  }
  std::sort(found.near_surface.begin(), found.near_surface.end());
  return absl::OkStatus();
}

/// A domain's own bricks, and those just beyond its upper faces.
BrickBox with_upper_faces(const BrickBox& domain) {
  return {domain.min, {domain.max.x + 1, domain.max.y + 1, domain.max.z + 1}};
}

}  // namespace

absl::StatusOr<FoundBricks> find_scene_bricks(const PhiField& field,
                                              const std::optional<BrickBox>& domain,
                                              std::size_t most_bricks,
                                              const Cancellation& cancellation) {
  const absl::StatusOr<BrickBox> reached =
      domain ? with_upper_faces(*domain) : reached_bricks(field);
  if (!reached.ok()) return reached.status();
  FoundBricks found;
  CubeLevel level = covering(*reached);
  while (level.edge > 1) {
    absl::StatusOr<CubeLevel> finer =
        refine(field, level, *reached, most_bricks, cancellation, found);
    if (!finer.ok()) return finer.status();
    level = *std::move(finer);
    if (auto status = check_cubes(level, most_bricks); !status.ok()) return status;
  }
  if (auto status = sort_bricks(field, level, cancellation, found); !status.ok()) return status;
  for (const BrickBox& box : found.inside) found.inside_cells += kBrickCells * bricks_in(box);
  return found;
}

}  // namespace tet
