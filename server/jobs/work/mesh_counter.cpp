#include "server/jobs/work/mesh_counter.h"

#include <exception>
#include <future>
#include <utility>

#include "core/plan/brick/divided_survey.h"
#include "core/plan/plan_price.h"
#include "server/rpc/background.h"
#include "server/rpc/explain.h"

namespace tet {

absl::StatusOr<PlannedMesh> MeshCounter::count(const CountOrder& order,
                                               SurveyedBlocks surveyed) {
  std::promise<absl::StatusOr<PlannedMesh>> promise;
  engine_.planner.plan(background_client(order.mesh.space), order.mesh, order.watch,
                       [&promise](absl::StatusOr<PlannedMesh> planned) {
                         promise.set_value(std::move(planned));
                       },
                       {.blocks = std::move(surveyed)});
  return promise.get_future().get();
}

absl::StatusOr<std::int64_t> MeshCounter::blocks(const CountOrder& order,
                                                 std::int64_t block_bricks) {
  const auto input = load(order);
  if (!input.ok()) return input.status();
  // Nearly all meshes are known to be small without looking for their bricks.
  const double worth_looking = 2.0 * static_cast<double>(block_bricks);
  if (estimate_bricks_to_plan(input->shape, input->request) < worth_looking) return 1;
  absl::StatusOr<std::size_t> blocks;
  run_large(order, [&] {
    blocks =
        count_survey_blocks(input->shape, input->request, engine_.planner.limits(),
                            static_cast<std::size_t>(block_bricks), order.watch->cancellation);
  });
  if (!blocks.ok()) return about_mesh(blocks.status());
  return *blocks > 2 ? static_cast<std::int64_t>(*blocks) : 1;
}

absl::StatusOr<std::vector<std::byte>> MeshCounter::survey(const CountOrder& order,
                                                           std::int64_t block_bricks,
                                                           std::int64_t block) {
  const auto input = load(order);
  if (!input.ok()) return input.status();
  absl::StatusOr<std::vector<std::byte>> bytes;
  run_large(order, [&] {
    bytes = survey_block(input->shape, input->request, engine_.planner.limits(),
                         static_cast<std::size_t>(block_bricks),
                         static_cast<std::size_t>(block), order.watch->cancellation);
  });
  if (!bytes.ok()) return about_mesh(bytes.status());
  return bytes;
}

absl::StatusOr<PlanInput> MeshCounter::load(const CountOrder& order) {
  MeshOrder mesh = order.mesh;
  mesh.request.fields.clear();  // which no survey looks at
  std::promise<absl::StatusOr<PlanInput>> promise;
  engine_.planner.load(
      background_client(order.mesh.space), std::move(mesh), order.watch,
      [&promise](absl::StatusOr<PlanInput> input) { promise.set_value(std::move(input)); });
  return promise.get_future().get();
}

void MeshCounter::run_large(const CountOrder& order, absl::FunctionRef<void()> work) {
  std::promise<void> done;
  engine_.large.post(background_client(order.mesh.space), [&work, &done] {
    try {
      work();
      done.set_value();
    } catch (...) {
      done.set_exception(std::current_exception());
    }
  });
  done.get_future().get();  // throws what the work did, in the shard's own thread
}

}  // namespace tet
