#include <memory>
#include <mutex>
#include <utility>

#include "client/command/mesh/label_report.h"
#include "client/command/mesh/mesh_maker.h"
#include "client/command/mesh/read_shape.h"
#include "client/command/mesh/written_mesh.h"
#include "client/command/process/stopwatch.h"
#include "core/base/parallel.h"
#include "core/plan/make/mesher.h"

namespace tet {

absl::StatusOr<MadeMesh> make_mesh_here(const MeshOptions& options,
                                        ProgressBar& bar,
                                        const Cancellation& interruption) {
  Stopwatch watch;
  TaskPool pool(options.threads);
  absl::StatusOr<ReadShape> input = absl::UnknownError("not read");
  pool.run([&] { input = read_shape(options, bar, interruption); });
  if (!input.ok()) return input.status();
  absl::StatusOr<MeshRequest> request = read_request(options, interruption);
  if (!request.ok()) return request.status();
  WrittenMesh written(options, interruption);
  written.ask_for_faces(input->shape, *request);
  const double reading_seconds = watch.lap();

  bar.begin("planning");
  std::once_flag planned;  // the first chunk says so
  const auto show = [&](double fraction) {
    std::call_once(planned, [&] { bar.begin("meshing"); });
    bar.update(fraction, 1);
  };
  absl::StatusOr<MeshResult> result = mesh_volume(
      pool,
      {.shape = input->shape,
       .request = *request,
       .progress = show,
       .choose_taker = [&](const MeshHeader& header) { return written.choose_taker(header); }},
      interruption);
  if (!result.ok()) return result.status();
  MadeMesh made{.mesh = std::move(result->mesh),
                .quality = result->quality,
                .boundary = result->boundary,
                .improvement = result->improvement,
                .thin_walls = std::move(result->thin_walls),
                .surface = input->surface,
                .stages = {{"reading", reading_seconds},
                           {"planning", result->plan_seconds},
                           {"meshing", result->fill_seconds}}};
  if (request->labels) made.voxel_volumes = voxel_volumes_of(input->shape, *request);
  if (!options.report.empty() || options.order > 1) {
    made.shape = std::move(input->shape);
    made.fields = request->fields;
  }
  if (written.is_begun()) {
    watch.lap();
    bar.begin("writing");
    if (auto status = written.finish(made); !status.ok()) return status;
    made.stages.push_back({"writing", watch.lap()});
  }
  if (made.improvement) made.stages.push_back({"improving", result->improve_seconds});
  return made;
}

}  // namespace tet
