#include "core/mesh/improve.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/base/extreme_angles.h"
#include "core/base/parallel.h"
#include "core/mesh/load_batch.h"
#include "core/mesh/star.h"
#include "core/mesh/tets_per_range.h"
#include "core/mesh/vertex_mover.h"
#include "core/mesh/vertex_stars.h"

namespace tet {
namespace {

constexpr std::size_t kStarsPerRange = 32;
/// Twelve end at the same angles as four on bunny, torus and gyroid.
constexpr int kSweeps = 4;

/// Tets with angles that are not good, ascending, and the angles of all.
struct AngleSurvey {
  AngleRange angles;
  std::vector<std::uint64_t> bad_tets;

  void add(const AngleSurvey& other) {
    angles.add(other.angles);
    bad_tets.insert(bad_tets.end(), other.bad_tets.begin(), other.bad_tets.end());
  }
};

AngleSurvey survey_range(const MeshView& view,
                         const AngleGoal& goal,
                         std::uint64_t begin,
                         std::uint64_t end) {
  AngleSurvey survey;
  ExtremeAngles extremes;
  TetBatch batch;
  BatchAngles angles;
  for (std::uint64_t first = begin; first < end; first += TetBatch::kSize) {
    const std::size_t count = std::min<std::uint64_t>(TetBatch::kSize, end - first);
    load_batch(view, first, count, batch);
    measure_batch(batch, angles);
    extremes.add(angles, count,
                 [&](std::size_t lane) { return view.stored_places(first + lane); });
    for (std::size_t i = 0; i < count; ++i) {
      const AngleRange range{angles.largest_cosine[i], angles.smallest_cosine[i]};
      if (!goal.met_by(range)) survey.bad_tets.push_back(first + i);
    }
  }
  survey.angles = extremes.range();
  return survey;
}

AngleSurvey survey_angles(const TetMesh& mesh, const AngleGoal& goal) {
  const std::uint64_t tets = mesh.header.tet_count;
  std::vector<AngleSurvey> ranges((tets + kTetsPerRange - 1) / kTetsPerRange);
  for_each_index(ranges.size(), [&](std::size_t r) {
    const std::uint64_t begin = r * kTetsPerRange;
    ranges[r] = survey_range(mesh.view(), goal, begin, std::min(begin + kTetsPerRange, tets));
  });
  AngleSurvey survey;
  for (const AngleSurvey& range : ranges) survey.add(range);
  return survey;
}

AngleGoal good_angles() {
  return {{signed_square_of_cosine(kGoodMinDihedralDeg),
           signed_square_of_cosine(kGoodMaxDihedralDeg)}};
}

/// What is remembered of a vertex from sweep to sweep.
struct VertexState {
  WorldPoint home;  ///< before the first move
  bool good = false;
  bool moved = false;
  bool reopens = false;  ///< moved in this sweep, but its star is not good yet
};

/// Moves vertices, one independent set of them after the other.
class Sweeper {
 public:
  Sweeper(TetMesh& mesh,
          const PhiField& field,
          const LatticeToWorld& to_world,
          const KnownOfVertices& known,
          const AngleSurvey& survey)
      : mesh_(mesh),
        field_(field),
        to_world_(to_world),
        known_(known),
        angles_(survey.angles),
        stars_(mesh, survey.bad_tets),
        sets_(independent_sets(mesh, stars_)),
        states_(stars_.size()) {
    for (std::size_t i = 0; i < stars_.size(); ++i) {
      states_[i].home = mesh.stored_position(stars_.vertex(i));
    }
  }

  /// Once cancelled, some of it.
  void sweep(const Cancellation& cancellation) {
    for (const std::vector<std::uint32_t>& set : sets_) {
      for_each_range(set.size(), kStarsPerRange, [&](std::size_t begin, std::size_t end) {
        if (cancellation.requested()) return;
        VertexMover mover(mesh_, field_, to_world_, good_angles(), angles_);
        for (std::size_t i = begin; i < end; ++i) move(set[i], mover);
      });
    }
    for (std::uint32_t i = 0; i < stars_.size(); ++i) {
      if (states_[i].reopens) reopen_around(i);
    }
  }

  std::uint64_t moved_vertices() const {
    return static_cast<std::uint64_t>(std::count_if(
        states_.begin(), states_.end(), [](const VertexState& state) { return state.moved; }));
  }

 private:
  void move(std::uint32_t i, VertexMover& mover) noexcept {
    VertexState& state = states_[i];
    if (state.good) return;
    const std::uint64_t vertex = stars_.vertex(i);
    if (!known_.stay.empty() && known_.stay[vertex] != 0) return;
    const int level = known_.levels.empty() ? 0 : known_.levels[vertex];
    const auto outcome = mover.move(vertex, stars_.star(i), state.home, std::ldexp(1.0, level));
    state.good = outcome.good;
    if (!outcome.place) return;
    mesh_.store_position(vertex, *outcome.place);
    state.moved = true;
    state.reopens = !outcome.good;
  }

  /// A move that helps a bad star may cost its good tets so much that they are not good any
  /// more.
  void reopen_around(std::uint32_t i) {
    states_[i].reopens = false;
    for (const TetCorner corner : stars_.star(i)) {
      for (const std::uint64_t vertex : mesh_.tet(corner.tet())) {
        const std::uint32_t other = stars_.number(vertex);
        if (other != VertexStars::kNotChosen) states_[other].good = false;
      }
    }
  }

  TetMesh& mesh_;
  const PhiField& field_;
  const LatticeToWorld& to_world_;
  const KnownOfVertices known_;
  const AngleRange angles_;  // of the mesh before
  const VertexStars stars_;
  const std::vector<std::vector<std::uint32_t>> sets_;
  std::vector<VertexState> states_;
};

}  // namespace

Improvement improve_mesh(TetMesh& mesh,
                         const PhiField& field,
                         const LatticeToWorld& to_world,
                         const KnownOfVertices& known,
                         const Cancellation& cancellation) {
  const auto start = std::chrono::steady_clock::now();
  const AngleSurvey survey = survey_angles(mesh, good_angles());
  Improvement improvement;
  if (!survey.angles.empty()) {
    improvement.min_dihedral_before_deg = degrees_of(survey.angles.largest_cosine);
    improvement.max_dihedral_before_deg = degrees_of(survey.angles.smallest_cosine);
  }
  if (!survey.bad_tets.empty() && !cancellation.requested()) {
    Sweeper sweeper(mesh, field, to_world, known, survey);
    for (int i = 0; i < kSweeps && !cancellation.requested(); ++i) sweeper.sweep(cancellation);
    improvement.moved_vertices = sweeper.moved_vertices();
  }
  improvement.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return improvement;
}

}  // namespace tet
