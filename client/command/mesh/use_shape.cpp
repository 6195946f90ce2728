#include "client/command/mesh/use_shape.h"

#include <new>
#include <string>
#include <utility>

#include <absl/strings/str_cat.h>

#include "client/command/mesh/label_report.h"
#include "client/command/mesh/read_shape.h"
#include "client/command/process/stopwatch.h"
#include "core/base/parallel.h"
#include "core/base/printable.h"
#include "core/second_order/second_order.h"

namespace tet {
namespace {

/// Reads the input once more where a server made the mesh.
absl::Status need_shape(const MeshOptions& options,
                        TaskPool& pool,
                        ProgressBar& bar,
                        const Cancellation& interruption,
                        MadeMesh& made) {
  if (made.shape) return absl::OkStatus();
  absl::StatusOr<ReadShape> read = absl::UnknownError("not read");
  pool.run([&] { read = read_shape(options, bar, interruption); });
  if (!read.ok()) return read.status();
  made.shape = std::move(read->shape);
  return absl::OkStatus();
}

/// What `measure` returns, or that memory ended meanwhile: the mesh needs none of it.
template <class Measure>
absl::Status caught(const Measure& measure) {
  try {
    return measure();
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError("there is not enough memory");
  }
}

}  // namespace

absl::Status add_middle_nodes(const MeshOptions& options,
                              MadeMesh& made,
                              ProgressBar& bar,
                              const Cancellation& interruption) {
  const Stopwatch watch;
  TaskPool pool(options.threads);
  if (auto status = need_shape(options, pool, bar, interruption, made); !status.ok()) {
    return status;
  }
  bar.begin("curving");
  MeshRequest request = options.request;
  request.fields = made.fields;
  absl::StatusOr<MiddleNodes> middles = absl::UnknownError("not made");
  pool.run([&] { middles = make_second_order(made.mesh, *made.shape, request, interruption); });
  if (!middles.ok()) return middles.status();
  made.middles = *std::move(middles);
  made.stages.push_back({"curving", watch.seconds()});
  return absl::OkStatus();
}

absl::Status add_voxel_volumes(const MeshOptions& options,
                               MadeMesh& made,
                               ProgressBar& bar,
                               const Cancellation& interruption) {
  if (!made.voxel_volumes.empty()) return absl::OkStatus();
  TaskPool pool(options.threads);
  const absl::Status added = caught([&] {
    absl::Status read = need_shape(options, pool, bar, interruption, made);
    if (read.ok()) made.voxel_volumes = voxel_volumes_of(*made.shape, options.request);
    return read;
  });
  if (auto status = check_cancelled(interruption); !status.ok()) return status;
  if (!added.ok()) {
    bar.say_lines(
        for_terminal(absl::StrCat("note: the report does not tell the volumes of the voxels: ",
                                  added.message())),
        stderr);
  }
  return absl::OkStatus();
}

absl::Status check_fidelity(const MeshOptions& options,
                            MadeMesh& made,
                            ProgressBar& bar,
                            const Cancellation& interruption) {
  const Stopwatch watch;
  TaskPool pool(options.threads);
  const absl::Status measured = caught([&] {
    if (auto read = need_shape(options, pool, bar, interruption, made); !read.ok()) return read;
    bar.begin("checking");
    absl::StatusOr<std::vector<Fidelity>> fidelity = absl::UnknownError("not measured");
    pool.run([&] {
      fidelity = measure_fidelity(made.mesh, *made.shape, options.request, interruption);
    });
    if (!fidelity.ok()) return fidelity.status();
    made.fidelity = *std::move(fidelity);
    return absl::OkStatus();
  });
  if (auto status = check_cancelled(interruption); !status.ok()) return status;
  made.stages.push_back({"checking", watch.seconds()});
  if (!measured.ok()) made.fidelity_missing = std::string(measured.message());
  return absl::OkStatus();
}

}  // namespace tet
