#include "core/base/tet_batch.h"

#include "core/base/lane_angles.h"
#include "core/base/vector_clones.h"

namespace tet {

TET_VECTOR_CLONES
void measure_batch(const TetBatch& __restrict batch, BatchAngles& __restrict angles) noexcept {
  const auto& [u, v, w] = batch.edge;
  for (std::size_t i = 0; i < TetBatch::kSize; ++i) {
    const LaneAngles lane = measure_lane({u.x[i], u.y[i], u.z[i]}, {v.x[i], v.y[i], v.z[i]},
                                         {w.x[i], w.y[i], w.z[i]});
    float largest = lane.cosine[0], smallest = lane.cosine[0];
#pragma GCC unroll 6  // a loop within would keep the lanes from becoming vectors
    for (std::size_t edge = 0; edge < 6; ++edge) {
      angles.cosine[edge][i] = lane.cosine[edge];
      largest = higher(largest, lane.cosine[edge]);
      smallest = lower(smallest, lane.cosine[edge]);
    }
    angles.largest_cosine[i] = largest;
    angles.smallest_cosine[i] = smallest;
    angles.six_volumes[i] = lane.six_volumes;
  }
}

}  // namespace tet
