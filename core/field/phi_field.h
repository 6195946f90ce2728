// The field that is meshed: phi, negative inside, sampled on the lattice.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "core/base/brick_mask.h"
#include "core/base/cancel.h"
#include "core/base/types.h"
#include "core/volume/inside.h"
#include "core/volume/volume.h"
#include "core/volume/volume_reader.h"
#include "core/volume/voxel_block.h"

namespace tet {

struct Scene;
struct Sides;
class BrickSides;
class SceneEvaluator;

/// A volume seen at an iso value and a lattice spacing: phi = sign * (value - iso). Or a scene,
/// whose phi is its own, and whose voxels are world units. A volume whose voxels are no cubes
/// has a scene beside it, which stands for it: core/scene/grid_scene.h.
///
/// Lattice corner (i, j, k) lies at voxel `spacing_voxels` * (i, j, k); with spacing 1 corners
/// sit on voxel centres and their samples are the stored values.
struct PhiField {
  const Volume* volume = nullptr;
  const Scene* scene = nullptr;  ///< instead of a volume, or of its voxels
  float iso = 0;
  std::optional<InsideSide> inside = {};  ///< of a volume; its own unless given
  double spacing_voxels = 1;

  /// Larger values are cut to this, so that sums of eight stay finite.
  static constexpr float kMaxPhi = 1e37F;

  bool at_voxels() const noexcept { return scene == nullptr && spacing_voxels == 1; }
  /// Between two nodes lie voxels that they do not see.
  bool coarser_than_voxels() const noexcept { return scene == nullptr && spacing_voxels > 1; }
  bool negated() const noexcept {
    return volume != nullptr && inside_side(*volume, inside) == InsideSide::kAbove;
  }
  float phi(float value) const noexcept;
  /// phi within what sums can bear; no zero has a sign.
  template <class Real>
  static float clamped(Real phi) noexcept {
    // One choice, by magnitude: clamping at both ends in turn is a branch to most compilers.
    const Real size = std::abs(phi), most = kMaxPhi;
    return static_cast<float>(std::copysign(size < most ? size : most, phi)) + 0.0F;
  }

  /// world = linear * voxel + translation.
  VoxelTransform voxel_transform() const noexcept {
    return scene == nullptr ? volume->transform : VoxelTransform{};
  }
  /// world = linear * lattice + translation, lattice in units of the spacing.
  VoxelTransform lattice_transform() const noexcept;
};

/// Whether a value lies inside: the sign of phi without its arithmetic, for loops.
struct InsideTestOfValue {
  float iso;
  bool above;
  explicit InsideTestOfValue(const PhiField& field) noexcept
      : iso(field.iso), above(field.negated()) {}
  bool operator()(float value) const noexcept { return above ? value > iso : value < iso; }
};

/// The first node of a halo along each axis, and the nodes of a row and of a slice.
inline constexpr int kHaloMin = -2;
inline constexpr std::size_t kHaloRow = offset_index(0, 1, 0),
                             kHaloSlice = offset_index(1, 0, 0);

/// Samples of a brick of finest cells and its halo, as columns by `halo_index`.
///
/// Corner (x, y, z) is the cell's lowest; centre (x, y, z) is the cell's own. Valid for corners
/// in
/// [-2, 10]^3 and centres in [-2, 9]^3, the rest is unspecified.
struct BrickSamples {
  alignas(64) std::array<float, kHaloNodes> corner;
  alignas(64) std::array<float, kHaloNodes> centre;
};

/// Samples phi. Not thread-safe: one per task.
class PhiSampler {
 public:
  explicit PhiSampler(const PhiField& field);
  ~PhiSampler();
  PhiSampler(PhiSampler&&) noexcept;
  PhiSampler& operator=(PhiSampler&&) noexcept;

  const PhiField& field() const noexcept { return field_; }

  /// From now on it looks at `cancellation`, which must outlive it, also within the samples of
  /// one brick of a scene. Samples are made up once a look found it cancelled: discard what
  /// came of them.
  void stop_when(const Cancellation& cancellation) noexcept;

  /// From now on it takes what it has to know of stored bricks' sides from `sides`, which are
  /// of its field and must outlive it, and adds to that: other samplers need not look again.
  void remember_in(BrickSides& sides) noexcept;

  /// Fills `samples` for the lattice brick at `brick`.
  void sample(BrickCoord brick, BrickSamples& samples) noexcept;

  /// Whether all samples of a brick are inside, or none is; told at voxels, and false
  /// elsewhere. Takes less than sampling: only values of neighbours with both signs are looked
  /// at.
  bool one_sided(BrickCoord brick) noexcept;

  /// True when phi < 0 at a lattice corner: as its sample says, to the bit, so that a brick of
  /// one-sided samples lies on the side that is found at any of its corners.
  bool inside(std::int64_t x, std::int64_t y, std::int64_t z) noexcept;

  /// phi at a lattice point (units of the spacing): trilinear, or the scene's.
  float at(double x, double y, double z) noexcept;

  /// As many points of a brick and its halo as edges are worked on at a time, and phi there.
  static constexpr std::size_t kPoints = 16;
  struct Points {
    alignas(64) std::array<double, kPoints> x, y, z;
    alignas(64) std::array<float, kPoints> phi;
  };
  /// phi at each of the points, as `at` tells it. Not for scenes.
  void sample_points(BrickCoord brick, Points& points) noexcept;

  /// The evaluator of a scene, focused on the brick that was sampled last and its halo.
  SceneEvaluator& scene() noexcept { return *scene_; }

 private:
  Sides sides_of_part(const float* values, std::size_t part) noexcept;
  void gather_values(BrickCoord brick, BrickSamples& samples) noexcept;
  void interpolate(BrickCoord brick, BrickSamples& samples) noexcept;
  bool copy_around(BrickCoord brick) noexcept;

  PhiField field_;
  BrickSides* sides_ = nullptr;            // may be null
  std::optional<VolumeReader> reader_;     // of a volume
  std::unique_ptr<VoxelBlock> block_;      // around a brick, where the lattice is not on voxels
  std::unique_ptr<SceneEvaluator> scene_;  // of a scene
};

}  // namespace tet
