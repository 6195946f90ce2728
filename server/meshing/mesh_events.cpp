#include "server/meshing/mesh_events.h"

#include "core/plan/brick/brick_plan.h"
#include "core/transfer/mesh_patch.h"
#include "proto/convert/mesh_header.h"
#include "proto/convert/mesh_parts.h"
#include "proto/convert/statistics.h"

namespace tet {

v1::MeshEvent progress_event(const MeshProgress& progress) {
  v1::MeshEvent event;
  v1::MeshProgress& message = *event.mutable_progress();
  message.set_done_bricks(static_cast<std::int64_t>(progress.done.load()));
  message.set_total_bricks(static_cast<std::int64_t>(progress.total.load()));
  return event;
}

v1::MeshEvent header_event(const PlannedMesh& planned, const ChunkSource& source) {
  v1::MeshEvent event;
  v1::MeshHeader& header = *event.mutable_header();
  to_proto(source.plan->header(), header);
  header.set_mesh_id(planned.mesh_id);
  *header.mutable_canonical_request() = planned.canonical;
  if (source.patch) {
    to_proto(source.patch->kept(), *header.mutable_kept());
    header.mutable_kept()->set_patch_count(
        static_cast<std::int64_t>(source.patch->patch_count()));
  }
  if (source.encoding == v1::ENCODING_COMPACT) {
    to_proto(source.bricks().to_world(), *header.mutable_lattice());
  }
  return event;
}

v1::MeshEvent trailer_event(const ChunkSource& source,
                            std::uint64_t first,
                            std::uint64_t end,
                            const QualityStats& quality) {
  v1::MeshEvent event;
  v1::MeshTrailer& trailer = *event.mutable_trailer();
  trailer.set_first_chunk(static_cast<std::int64_t>(first));
  trailer.set_end_chunk(static_cast<std::int64_t>(end));
  const bool is_measured = source.plan->statistics() == Statistics::kMeasured;
  if (is_measured && source.encoding != v1::ENCODING_COMPACT) {
    to_proto(quality, *trailer.mutable_quality());
  }
  const MeshPlan& plan = *source.plan;
  if (plan.boundary()) to_proto(*plan.boundary(), *trailer.mutable_boundary());
  if (plan.improvement()) to_proto(*plan.improvement(), *trailer.mutable_improvement());
  to_proto(plan.thin_walls(), *trailer.mutable_thin_walls());
  return event;
}

}  // namespace tet
