#include <memory>
#include <mutex>
#include <utility>

#include "client/mesh_maker.h"
#include "client/read_grids.h"
#include "client/scene_input.h"
#include "client/stopwatch.h"
#include "client/surface_input.h"
#include "core/base/parallel.h"
#include "core/pipeline/mesher.h"

namespace tet {
namespace {

absl::StatusOr<Volume> convert_surface(const MeshOptions& options, ProgressBar& bar) {
  absl::StatusOr<SurfaceInput> input = read_surface_input(options.input, options.voxel);
  if (!input.ok()) return input.status();
  absl::StatusOr<SurfaceVolume> converted =
      surface_to_volume(input->surface, input->voxel_size);
  if (!converted.ok()) return converted.status();
  bar.say(options.input + ": " + describe_conversion(converted->report, input->voxel_size));
  return std::move(converted->volume);
}

absl::StatusOr<Volume> read_grid(const MeshOptions& options,
                                 ProgressBar& bar,
                                 const Cancellation& interruption) {
  if (is_surface_file(options.input)) return convert_surface(options, bar);
  return read_volume(options.input, options.grid,
                     options.trust ? FileTrust::kFull : FileTrust::kNone, interruption);
}

/// Takes what was read.
template <class Input>
absl::StatusOr<Shape> shared(absl::StatusOr<Input> read) {
  if (!read.ok()) return read.status();
  return std::make_shared<const Input>(*std::move(read));
}

absl::StatusOr<Shape> read_input(const MeshOptions& options,
                                 ProgressBar& bar,
                                 const Cancellation& interruption) {
  bar.begin("reading");
  return is_scene_file(options.input) ? shared(read_scene(options.input))
                                      : shared(read_grid(options, bar, interruption));
}

}  // namespace

absl::StatusOr<MadeMesh> make_mesh_here(const MeshOptions& options,
                                        ProgressBar& bar,
                                        const Cancellation& interruption) {
  Stopwatch watch;
  TaskPool pool(options.threads);
  absl::StatusOr<Shape> input = absl::UnknownError("not read");
  pool.run([&] { input = read_input(options, bar, interruption); });
  if (!input.ok()) return input.status();
  const double reading_seconds = watch.lap();

  bar.begin("planning");
  std::once_flag planned;  // the first chunk says so
  const auto show = [&](double fraction) {
    std::call_once(planned, [&] { bar.begin("meshing"); });
    bar.update(fraction, 1);
  };
  absl::StatusOr<MeshResult> result =
      mesh_volume(pool, *std::move(input), options.request, MeshLimits{}, interruption, show);
  if (!result.ok()) return result.status();
  MadeMesh made{
      .mesh = std::move(result->mesh),
      .quality = result->quality,
      .boundary = result->boundary,
      .improvement = result->improvement,
      .thin_walls = std::move(result->thin_walls),
      .stages = {{"reading", reading_seconds},
                 {"planning", result->plan_seconds},
                 {"meshing", result->fill_seconds}}
  };
  if (made.improvement) made.stages.push_back({"improving", result->improve_seconds});
  return made;
}

}  // namespace tet
