// Which of the request's regions a face of the surface is in.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/cancel.h"
#include "core/base/types.h"
#include "core/base/vec3.h"
#include "core/mesh/tet_mesh.h"
#include "core/scene/scene_evaluator.h"

namespace tet {

/// World coordinates of a face's vertices, counter-clockwise seen from outside.
using FacePlace = std::array<WorldPoint, 3>;

/// Labels faces of the surface by the header's regions. What it says of a face depends on the
/// face alone. Not thread-safe: one per task.
class FaceLabeller {
 public:
  /// Both must outlive it; without a scene, which may be null, no node made a face.
  FaceLabeller(const MeshHeader& header, const Scene* scene);

  bool empty() const noexcept { return regions_.empty(); }

  /// From now on it looks at `cancellation`, which must outlive it, between few thousand values
  /// of a scene's instructions. Labels are made up once a look found it cancelled.
  void stop_when(const Cancellation& cancellation) noexcept {
    if (scene_) scene_->stop_when(cancellation);
  }

  /// Until the next focus most faces lie in the cube around `centre`: they are labelled sooner.
  void focus(const WorldPoint& centre, double half_edge) noexcept;

  /// The label of the first region that the face is in, or 0, the surface's.
  std::uint16_t label_of(const FacePlace& face) noexcept;

 private:
  struct NearPoint {
    WorldPoint place;
    std::size_t region = 0;
  };
  /// What follows from a region's conditions.
  struct Prepared {
    std::uint16_t label = 0;
    Vector along{};            ///< of the cylinder, one long
    double length = 0;         ///< of the cylinder
    Vector normal{};           ///< of the half space, one long
    Vector direction{};        ///< that faces look in, one long
    double least_cos = 0;      ///< of the angle to it
    std::vector<bool> leaves;  ///< instructions of the scene that are the node's
  };

  Prepared prepare(const FaceRegion& region, const Scene* scene) const;
  bool has(std::size_t i, const WorldPoint& middle, const FacePlace& face) noexcept;
  std::size_t nearest_to(const WorldPoint& middle) const noexcept;

  std::span<const FaceRegion> regions_;
  std::vector<Prepared> prepared_;
  std::vector<NearPoint> points_;
  std::optional<SceneEvaluator> scene_;  ///< where a region has a node
};

/// Labels the surface's faces of a whole mesh that has them, by its header's regions; some of
/// them once cancelled. Parallel.
void label_regions(TetMesh& mesh, const Scene* scene, const Cancellation& cancellation = {});

}  // namespace tet
