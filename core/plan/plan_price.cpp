#include "core/plan/plan_price.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <variant>
#include <vector>

#include "core/scene/scene.h"
#include "core/scene/scene_evaluator.h"
#include "core/volume/inside.h"
#include "core/volume/label_volume.h"

namespace tet {
namespace {

/// Bricks of a shape that are looked at.
constexpr std::size_t kLooks = 64;

// In bricks of a plain surface; found with cost_trial.

/// Counting a brick of the inside.
constexpr double kInside = 1.0 / 32;
/// Improving a brick, restoring nodes of it, both sides of it, grading the surface of it.
constexpr double kImprovement = 10, kManifold = 2, kBothSides = 2.5, kGraded = 9;
/// The mesh is made once more for its faces, and these are searched.
constexpr double kCreases = 7;
/// What grows slowly away from a brick, for each part of a spacing that it grows by less.
constexpr double kGrowth = 0.5;
/// A brick of values without a surface; one that is not the lattice's own.
constexpr double kNoSurface = 1.0 / 16, kOffLattice = 20;
/// Surface in every cell, beside a plain one.
constexpr double kMostSurface = 12;
/// A brick of a scene; and of each of its instructions, whether or not it matters in a brick.
constexpr double kSceneBrick = 2, kInstruction = 1.0 / 100;
/// An instruction that matters in a brick, and that times its surface.
constexpr double kEvaluation = 0.04, kSearch = 0.125;
/// A label that a brick has.
constexpr double kLabel = 15;
/// A brick of a face of a cube of voxels, which is looked for.
constexpr double kFaceOfCube = 1.0 / 16;

/// Bricks near the surface, each at its price, and bricks inside.
struct BrickPrices {
  double surface = 0, inside = 0;
};

/// Whether there is anything to be meshed: in a box that ends.
bool has_extent(const Scene& scene, const MeshRequest& request) {
  const auto& [min, max] = request.box ? *request.box : scene.extent;
  const bool ends = std::isfinite(max.x - min.x) && std::isfinite(max.y - min.y) &&
                    std::isfinite(max.z - min.z);
  return ends && min.x <= max.x && min.y <= max.y && min.z <= max.z;
}

double cost_of(scene::Op op) {
  switch (op) {
    case scene::Op::kGyroid:
    case scene::Op::kSchwarzP:
    case scene::Op::kDiamond:
      return 8;
    case scene::Op::kGrid:
      return 4;
    default:
      return 1;
  }
}

/// A few bricks of a scene's box: how many of them meet the surface, and what these cost, in
/// the middle.
class SceneLook {
 public:
  SceneLook(const Scene& scene, const WorldBox& box, double spacing)
      : scene_(scene), evaluator_(scene), half_(0.5 * kBrickEdge * spacing) {
    find_cubes(box);
    for (std::size_t i = 0; i < kLooks && !cubes_.empty(); ++i) {
      look_at(point_in(cubes_[i % cubes_.size()], i));
    }
    if (met_ > 0) price_ /= static_cast<double>(met_);
  }

  /// Parts of the box that the surface may meet, of all; and of looks there those that met it.
  double cubes() const { return static_cast<double>(cubes_.size()) / kLooks; }
  double met() const { return static_cast<double>(met_) / kLooks; }
  double price() const { return price_; }

 private:
  static constexpr int kAcross = 4;
  static_assert(kAcross * kAcross * kAcross == kLooks);

  bool may_meet(const WorldPoint& middle, double half) {
    evaluator_.focus(middle, half);
    points_.x[0] = middle.x;
    points_.y[0] = middle.y;
    points_.z[0] = middle.z;
    const auto& [low, high] = evaluator_.bounds(points_, 1, half);
    return low.at[0] <= 0 && high.at[0] >= 0;
  }

  void find_cubes(const WorldBox& box) {
    const auto& [min, max] = box;
    edges_ = {(max.x - min.x) / kAcross, (max.y - min.y) / kAcross, (max.z - min.z) / kAcross};
    const double half = 0.5 * std::max({edges_.x, edges_.y, edges_.z});
    for (int i = 0; i < kAcross * kAcross * kAcross; ++i) {
      const int x = i / (kAcross * kAcross), y = i / kAcross % kAcross, z = i % kAcross;
      const WorldPoint low{min.x + x * edges_.x, min.y + y * edges_.y, min.z + z * edges_.z};
      const WorldPoint middle{low.x + 0.5 * edges_.x, low.y + 0.5 * edges_.y,
                              low.z + 0.5 * edges_.z};
      if (may_meet(middle, half)) cubes_.push_back(low);
    }
  }

  /// Points are the same ones every time, and are spread as no lattice of a scene is.
  WorldPoint point_in(const WorldPoint& low, std::size_t i) const {
    const auto along = [i](double from, double edge, double step) {
      const double at = 0.5 + static_cast<double>(i) * step;
      return from + edge * (at - std::floor(at));
    };
    return {along(low.x, edges_.x, 0.8191725), along(low.y, edges_.y, 0.6710436),
            along(low.z, edges_.z, 0.5497005)};
  }

  void look_at(const WorldPoint& middle) {
    if (!may_meet(middle, half_)) return;
    ++met_;
    double instructions = 0;
    for (const std::uint32_t i : evaluator_.in_focus()) {
      instructions += cost_of(scene_.program[i].op);
    }
    price_ += kSceneBrick + instructions * (kEvaluation + kSearch * surface_at(middle));
  }

  /// How much surface is in the brick, beside a plain one: by signs at points of it.
  double surface_at(const WorldPoint& middle) {
    for (std::size_t i = 0; i < kLooks; ++i) {
      const auto along = [this](double at, std::size_t step) {
        return at + half_ * (0.5 * static_cast<double>(step) - 0.75);
      };
      points_.x[i] = along(middle.x, i / 16);
      points_.y[i] = along(middle.y, i / 4 % 4);
      points_.z[i] = along(middle.z, i % 4);
    }
    const double* phi = evaluator_.evaluate(points_, kLooks);
    std::size_t changes = 0;
    for (std::size_t i = 0; i < kLooks; ++i) {
      const auto differs = [&](std::size_t step) {
        return (phi[i] < 0) != (phi[i + step] < 0);
      };
      changes += i / 16 < 3 && differs(16) ? 1 : 0;
      changes += i / 4 % 4 < 3 && differs(4) ? 1 : 0;
      changes += i % 4 < 3 && differs(1) ? 1 : 0;
    }
    return static_cast<double>(changes) / 16;
  }

  const Scene& scene_;
  SceneEvaluator evaluator_;
  const double half_;  ///< a brick's edge
  WorldPoint edges_;   ///< of cubes
  std::vector<WorldPoint> cubes_;
  scene::Points points_{};
  std::size_t met_ = 0;
  double price_ = 0;
};

/// A few looks do not find a surface that is thin in its cubes: it is about as large as their
/// faces then.
BrickPrices price_bricks(const Scene& scene, const MeshRequest& request, double spacing) {
  const auto& [min, max] = request.box ? *request.box : scene.extent;
  const double brick = kBrickEdge * spacing;
  const double x = (max.x - min.x) / brick + 1, y = (max.y - min.y) / brick + 1,
               z = (max.z - min.z) / brick + 1;
  const double all = x * y * z;
  const SceneLook look(scene, {min, max}, spacing);
  const double found = all * look.cubes() * look.met();
  const double faces = look.met() < 0.125
                           ? std::min(all, 1.3 * look.cubes() * 4 * (x * y + y * z + z * x) / 3)
                           : 0;
  const double looked = kInstruction * static_cast<double>(scene.program.size());
  return {std::max(found, faces) * (std::max(look.price(), kSceneBrick) + looked), all};
}

/// How much surface is in a brick of values, beside a plain one: by crossed edges.
double surface_in(const float* values, double iso) {
  constexpr double kPlain = 64;  // edges that a plain surface crosses, in the middle
  std::size_t crossed = 0;
  for (std::size_t i = 0; i < kBrickCells; ++i) {
    const auto differs = [&](std::size_t step) {
      return (values[i] < iso) != (values[i + step] < iso);
    };
    crossed += i / 64 < 7 && differs(64) ? 1 : 0;
    crossed += i / 8 % 8 < 7 && differs(8) ? 1 : 0;
    crossed += i % 8 < 7 && differs(1) ? 1 : 0;
  }
  return static_cast<double>(crossed) / kPlain;
}

/// The price of a stored brick where `finer` spacings are a voxel, from a few of them; `off` is
/// kOffLattice where the lattice is not the voxels'.
double price_of_brick(const Volume& volume, double iso, double finer, double off) {
  const std::size_t bricks = volume.bricks.size();
  const std::size_t looks = std::min(bricks, kLooks);
  double price = 0;
  for (std::size_t i = 0; i < looks; ++i) {
    const std::size_t brick = (2 * i + 1) * bricks / (2 * looks);
    const ValueRange& range = volume.ranges[brick];
    price += kNoSurface;
    if (range.min > iso || range.max < iso) continue;
    const double surface = surface_in(volume.values.data() + brick * kBrickCells, iso);
    // A finer lattice has less of it in each brick, and no more bricks than there are.
    const double spread =
        std::max(surface, 0.5) * std::max(surface / kMostSurface, finer * finer);
    price += std::min(off * spread, 2 * kMostSurface * finer * finer * std::max(1.0, finer));
  }
  return looks == 0 ? 0 : price / static_cast<double>(looks);
}

/// Constant bricks of the regions that lie inside, from a few regions.
double bricks_inside(const Volume& volume, double iso) {
  const std::size_t looks = std::min(volume.regions.size(), kLooks);
  double inside = 0;
  for (std::size_t i = 0; i < looks; ++i) {
    const Region& region = volume.regions[(2 * i + 1) * volume.regions.size() / (2 * looks)];
    for (std::size_t brick = 0; brick < region.brick_index.size(); ++brick) {
      const bool is_inside =
          region.brick_index[brick] == Region::kConstant && region.constant[brick] < iso;
      inside += is_inside ? 1 : 0;
    }
  }
  return looks == 0
             ? 0
             : inside * static_cast<double>(volume.regions.size()) / static_cast<double>(looks);
}

BrickPrices price_bricks(const Volume& volume, const MeshRequest& request, double spacing) {
  const double finer = volume.transform.voxel_size / spacing;
  const double iso = request.iso.value_or(default_iso(volume, request.inside));
  const double off = std::abs(finer - 1) > 1e-9 ? kOffLattice : 1;
  double surface =
      price_of_brick(volume, iso, finer, off) * static_cast<double>(volume.bricks.size());
  double inside = bricks_inside(volume, iso);
  for (const ConstantCube& cube : volume.cubes) {
    const std::int32_t bricks_across = cube.edge / kBrickEdge;
    const double edge = bricks_across;
    surface += 6 * edge * edge * (kFaceOfCube + off * finer * finer);
    inside += edge * edge * edge;
  }
  return {surface, inside * finer * finer * finer};
}

/// Labels that a stored brick of 512 voxels has.
double labels_in(const std::uint16_t* values) {
  std::array<std::uint16_t, kBrickCells> sorted{};
  std::copy_n(values, sorted.size(), sorted.begin());
  std::ranges::sort(sorted);
  return static_cast<double>(std::unique(sorted.begin(), sorted.end()) - sorted.begin());
}

/// Labels meet in the bricks that have more than one; a lattice finer than the voxels has more
/// bricks, and a coarser one fewer. A node costs as many sums as there are labels near it.
double price_bricks(const LabelVolume& labels, double spacing) {
  constexpr double kOneLabel = 1.0 / 64;
  const std::size_t mixed = labels.values.size() / kBrickCells;
  const std::size_t looks = std::min(mixed, kLooks);
  double price = 0;
  for (std::size_t i = 0; i < looks; ++i) {
    const std::size_t brick = (2 * i + 1) * mixed / (2 * looks);
    price += kLabel * labels_in(labels.values.data() + brick * kBrickCells);
  }
  if (looks > 0) price *= static_cast<double>(mixed) / static_cast<double>(looks);
  const double finer = labels.transform.voxel_size / spacing;
  return finer * finer * price +
         kOneLabel * std::pow(finer, 3) * static_cast<double>(labels.bricks.size());
}

double contents_of(const std::monostate&) { return 0; }
double contents_of(const ShellRegion&) { return 0; }  // depends on the surface
double contents_of(const WorldBox& box) {
  const auto& [min, max] = box;
  return (max.x - min.x) * (max.y - min.y) * (max.z - min.z);
}
double contents_of(const CapsuleRegion& capsule) {
  const auto& [start, end, radius] = capsule;
  const double length = std::hypot(end.x - start.x, end.y - start.y, end.z - start.z);
  return std::numbers::pi * radius * radius * (length + 4.0 / 3 * radius);
}
double contents_of(const BallRegion& ball) {
  return contents_of(CapsuleRegion{ball.centre, ball.centre, ball.radius});
}

/// Bricks of leaves that regions of a sizing make smaller than they would be.
double sized_bricks(const Sizing& sizing) {
  double bricks = 0;
  for (const SizingRegion& region : sizing.regions) {
    const double volume =
        std::visit([](const auto& shape) { return contents_of(shape); }, region.shape);
    bricks += volume / std::pow(region.size, 3) / kBrickCells;
  }
  return bricks;
}

/// How often a plain plan's work a request asks for.
double times_plain(const MeshRequest& request) {
  double times = 1 + kGrowth * std::max(0.0, 1 / request.sizing.growth - 1);
  if (request.sizing.grade_surface) times *= kGraded;
  if (request.manifold) times *= kManifold;
  if (request.preset == Preset::kBothSides || request.labels) times *= kBothSides;
  if (request.improve) times *= kImprovement;
  if (have_creases(request.face_regions)) times *= kCreases;
  return times;
}

/// Prices a grid or a scene.
double price_solid(const Shape& shape, const MeshRequest& request, double spacing) {
  const Scene* scene = scene_of(shape);
  if (scene != nullptr && !has_extent(*scene, request)) return 0;  // refused at once
  const auto [surface, inside] = scene != nullptr
                                     ? price_bricks(*scene, request, spacing)
                                     : price_bricks(*volume_of(shape), request, spacing);
  const double finest =
      request.levels == 0 ? inside : std::min(inside, sized_bricks(request.sizing));
  return times_plain(request) * surface + kInside * finest;
}

}  // namespace

double estimate_bricks_to_plan(const Shape& shape, const MeshRequest& request) {
  if (const GridList* grids = grids_of(shape)) {
    double sum = 0;
    for (const auto& grid : *grids) sum += estimate_bricks_to_plan(grid, request);
    return sum;
  }
  const double spacing = request.spacing.value_or(default_spacing(shape));
  if (const auto labels = labels_of(shape)) return price_bricks(*labels, spacing);
  return price_solid(shape, request, spacing);
}

}  // namespace tet
