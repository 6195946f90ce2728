// Where two fields on one lattice differ, brick by brick.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/brick_index.h"
#include "core/field/phi_field.h"
#include "core/scene/scene_evaluator.h"

namespace tet {

/// Two volumes, or two scenes, seen at one spacing and iso value. What it was made of must
/// outlive it. Immutable: any number of threads may ask, each by its own
/// FieldDifference::Asker.
class FieldDifference {
 public:
  /// Lattice bricks that read what changed, each as often as it does: with more of them a mesh
  /// is planned anew rather than compared. A hundred megabytes.
  static constexpr double kMostReaders = 1 << 23;

  /// Null where next to nothing can be the same: other lattices, a volume beside a scene, or
  /// more than kMostReaders, as a spacing far below the voxels makes of few changes. All
  /// values of two volumes are compared, unless `replaced` names bricks of voxels, in any
  /// order, beyond which they are known to be the same. Parallel.
  static std::unique_ptr<const FieldDifference> between(
      const PhiField& earlier,
      const PhiField& now,
      const std::vector<BrickCoord>* replaced = nullptr);

  /// Not thread-safe: one per task.
  class Asker {
   public:
    explicit Asker(const FieldDifference& difference);

    /// True only if every sample in the lattice brick and its halo is what it was.
    bool same_around(BrickCoord brick);

   private:
    const FieldDifference& difference_;
    std::unique_ptr<SceneEvaluator> earlier_, now_;  // of scenes
  };

  /// Lattice bricks of two volumes, sorted: beyond them every sample in a brick and its halo is
  /// what it was. Null for scenes, of which each brick has to be asked about.
  const std::vector<BrickCoord>* touched() const noexcept {
    return now_.scene == nullptr ? &touched_ : nullptr;
  }

 private:
  FieldDifference(const PhiField& earlier, const PhiField& now)
      : earlier_(earlier), now_(now) {}

  PhiField earlier_, now_;
  // Lattice bricks that read a voxel that changed, sorted; filled for volumes only.
  std::vector<BrickCoord> touched_;
  BrickIndex touched_index_;
};

}  // namespace tet
