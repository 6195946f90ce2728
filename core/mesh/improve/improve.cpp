#include "core/mesh/improve/improve.h"

#include <chrono>
#include <cmath>

#include "core/mesh/improve/angle_survey.h"
#include "core/mesh/improve/sweeper.h"
#include "core/mesh/improve/vertex_mover.h"

namespace tet {
namespace {

/// Twelve end at the same angles as four on bunny, torus and gyroid.
constexpr int kSweeps = 4;

/// Moves vertices by what is known of them.
struct KnowingMover {
  VertexMover mover;
  const KnownOfVertices& known;

  VertexMover::Outcome move(std::uint64_t vertex,
                            std::span<const TetCorner> star,
                            const WorldPoint& home) {
    if (!known.stay.empty() && known.stay[vertex] != 0) return {};
    const int level = known.levels.empty() ? 0 : known.levels[vertex];
    return mover.move(vertex, star, home, std::ldexp(1.0, level));
  }
};

}  // namespace

Improvement improve_mesh(TetMesh& mesh,
                         const PhiField& field,
                         const LatticeToWorld& to_world,
                         const KnownOfVertices& known,
                         const Cancellation& cancellation) {
  const auto start = std::chrono::steady_clock::now();
  const AngleSurvey survey = survey_angles(mesh, good_angles());
  Improvement improvement = improvement_from(survey);
  if (!survey.bad_tets.empty() && !cancellation.requested()) {
    const AngleRange& angles = survey.angles;
    Sweeper sweeper(mesh, VertexStars(mesh, survey.bad_tets), [&] {
      return KnowingMover{VertexMover(mesh, field, to_world, good_angles(), angles), known};
    });
    for (int i = 0; i < kSweeps && !cancellation.requested(); ++i) sweeper.sweep(cancellation);
    improvement.moved_vertices = sweeper.moved_vertices();
  }
  improvement.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return improvement;
}

}  // namespace tet
