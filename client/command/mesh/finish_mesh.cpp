#include "client/command/mesh/finish_mesh.h"

#include <optional>
#include <utility>

#include "client/command/process/stopwatch.h"
#include "core/base/printable.h"
#include "core/files/mesh_file.h"

namespace tet {

MadeMesh made_of(StreamedMesh&& streamed, std::vector<Stage> stages) {
  return {.mesh = std::move(streamed.mesh),
          .quality = streamed.quality,
          .boundary = streamed.boundary,
          .improvement = streamed.improvement,
          .thin_walls = std::move(streamed.thin_walls),
          .surface = std::nullopt,
          .stages = std::move(stages)};
}

absl::Status write_made_mesh(const MeshOutput& output,
                             MadeMesh& made,
                             ProgressBar& bar,
                             const Cancellation& interruption) {
  if (!made.is_written) {
    const Stopwatch watch;
    bar.begin("writing");
    const WriteControl control{.cancellation = &interruption,
                               .progress = [&](double fraction) { bar.update(fraction, 1); }};
    const absl::Status status =
        write_mesh_file(output, {made.mesh, made.middles ? &*made.middles : nullptr}, control);
    made.stages.push_back({"writing", watch.seconds()});
    if (!status.ok()) return status;
  }
  for (const std::string& change : changed_names(output.format, made.mesh.header)) {
    bar.say_lines("note: " + for_terminal(change), stderr);
  }
  return absl::OkStatus();
}

}  // namespace tet
