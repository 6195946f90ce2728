#include "core/base/tet_batch.h"

#include <array>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/quality.h"

namespace tet {
namespace {

using TestTet = std::array<WorldPoint, 4>;

/// Tets of any shape and orientation, and among them one without volume and one that is a
/// point.
std::vector<TestTet> some_tets() {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  std::vector<TestTet> tets(5 * TetBatch::kSize);
  for (TestTet& tet : tets) {
    for (WorldPoint& p : tet) p = {coordinate(random), coordinate(random), coordinate(random)};
  }
  tets[3][3] = tets[3][0];
  tets[4] = {};
  return tets;
}

void load(const std::vector<TestTet>& tets, std::size_t first, TetBatch& batch) {
  for (std::size_t lane = 0; lane < TetBatch::kSize; ++lane) {
    for (std::size_t k = 0; k < 4; ++k) batch.set(lane, k, tets[first + lane][k]);
  }
}

TEST(TetBatch, HasTheBitsThatTetsHaveAlone) {
  const std::vector<TestTet> tets = some_tets();
  TetBatch batch;
  BatchAngles angles;
  for (std::size_t first = 0; first < tets.size(); first += TetBatch::kSize) {
    load(tets, first, batch);
    measure_batch(batch, angles);
    for (std::size_t i = 0; i < TetBatch::kSize; ++i) {
      const auto& [a, b, c, d] = tets[first + i];
      const auto cosines = dihedral_cosines(face_normals(a, b, c, d));
      AngleRange range;
      for (std::size_t edge = 0; edge < 6; ++edge) {
        EXPECT_EQ(angles.cosine[edge][i], cosines[edge]) << "tet " << first + i;
        range.add(cosines[edge]);
      }
      EXPECT_EQ(angles.largest_cosine[i], range.largest_cosine);
      EXPECT_EQ(angles.smallest_cosine[i], range.smallest_cosine);
    }
  }
}

TEST(QualityMeter, GathersABatchAsItGathersTets) {
  const std::vector<TestTet> tets = some_tets();
  constexpr std::size_t kLast = TetBatch::kSize - 5;  // of the last batch
  QualityMeter one_by_one, batches;
  TetBatch batch;
  BatchAngles angles;
  for (std::size_t first = 0; first < tets.size(); first += TetBatch::kSize) {
    const bool last = first + TetBatch::kSize == tets.size();
    const std::size_t count = last ? kLast : TetBatch::kSize;
    load(tets, first, batch);
    measure_batch(batch, angles);
    batches.add_batch(angles, count);
    for (std::size_t i = first; i < first + count; ++i) {
      one_by_one.add_tet(tets[i][0], tets[i][1], tets[i][2], tets[i][3]);
    }
  }
  const QualityStats expected = one_by_one.stats(), stats = batches.stats();
  EXPECT_EQ(stats.min_dihedral_deg, expected.min_dihedral_deg);
  EXPECT_EQ(stats.max_dihedral_deg, expected.max_dihedral_deg);
  EXPECT_EQ(stats.volume, expected.volume);
  EXPECT_EQ(stats.histogram, expected.histogram);
}

}  // namespace
}  // namespace tet
