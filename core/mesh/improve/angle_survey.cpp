#include "core/mesh/improve/angle_survey.h"

#include <algorithm>
#include <cstddef>

#include "core/base/extreme_angles.h"
#include "core/base/parallel.h"
#include "core/mesh/improve/improve.h"
#include "core/mesh/load_batch.h"
#include "core/mesh/tets_per_range.h"

namespace tet {
namespace {

AngleSurvey survey_range(const TetMesh& mesh,
                         const AngleGoal& goal,
                         std::uint64_t begin,
                         std::uint64_t end) {
  const MeshView view = mesh.view();
  const EdgeScale scale(mesh.header.spacing);
  AngleSurvey survey;
  ExtremeAngles extremes;
  TetBatch batch;
  BatchAngles angles;
  for (std::uint64_t first = begin; first < end; first += TetBatch::kSize) {
    const std::size_t count = std::min<std::uint64_t>(TetBatch::kSize, end - first);
    load_batch(view, first, count, scale, batch);
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

}  // namespace

Improvement improvement_from(const AngleSurvey& survey) {
  Improvement improvement;
  if (survey.angles.empty()) return improvement;
  improvement.min_dihedral_before_deg = degrees_of(survey.angles.largest_cosine);
  improvement.max_dihedral_before_deg = degrees_of(survey.angles.smallest_cosine);
  return improvement;
}

AngleSurvey survey_angles(const TetMesh& mesh, const AngleGoal& goal) {
  const std::uint64_t tets = mesh.header.tet_count;
  std::vector<AngleSurvey> ranges((tets + kTetsPerRange - 1) / kTetsPerRange);
  for_each_index(ranges.size(), [&](std::size_t r) {
    const std::uint64_t begin = r * kTetsPerRange;
    ranges[r] = survey_range(mesh, goal, begin, std::min(begin + kTetsPerRange, tets));
  });
  AngleSurvey survey;
  for (const AngleSurvey& range : ranges) survey.add(range);
  return survey;
}

AngleGoal good_angles() {
  return {{signed_square_of_cosine(kGoodMinDihedralDeg),
           signed_square_of_cosine(kGoodMaxDihedralDeg)}};
}

}  // namespace tet
