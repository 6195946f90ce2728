// `tetstream estimate`: what a mesh would take, without making it.
#include <cstdio>
#include <memory>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>
#include <absl/strings/str_format.h>
#include <nlohmann/json.hpp>

#include "client/command/arguments/mesh_arguments.h"
#include "client/command/arguments/placed_array.h"
#include "client/command/command.h"
#include "client/command/mesh/mesh_report.h"
#include "client/command/mesh/prepare_request.h"
#include "client/command/mesh/read_shape.h"
#include "client/command/process/stopwatch.h"
#include "client/library/mesh_client.h"
#include "core/base/parallel.h"
#include "core/base/printable.h"
#include "core/plan/make/fill_estimate.h"
#include "core/plan/make/plan_mesh.h"

namespace tet {
namespace {

constexpr const char* kEstimateExamples = R"(
Examples:
  tetstream estimate bunny.vdb --levels 0
  tetstream estimate bunny.vdb --sizing '{"growth": 0.25}' --json
  tetstream estimate bunny.vdb --spacing 0.01 --server localhost:7447
      what it takes there; the file is uploaded
)";

struct EstimateArguments {
  MeshArguments mesh;
  bool json = false;
};

/// What counting a mesh told; `bytes` is what its columns take in memory.
struct MeshEstimate {
  std::uint64_t vertices = 0, tets = 0, bytes = 0;
  double count_seconds = 0;  ///< that it took
  double fill_seconds = 0;   ///< that it would
  std::string inside_guess;  ///< as MeshHeader::inside_guess
};

absl::StatusOr<MeshEstimate> estimate_counted(const MeshOptions& options,
                                              ProgressBar& bar,
                                              const Cancellation& interruption) {
  const absl::StatusOr<ReadShape> input = read_shape(options, bar, interruption);
  if (!input.ok()) return input.status();
  absl::StatusOr<MeshRequest> request = read_request(options, interruption);
  if (!request.ok()) return request.status();
  ask_for_counts(*request);
  bar.begin("counting");
  Stopwatch watch;
  const auto plan = plan_mesh({.shape = input->shape, .request = *request}, interruption);
  if (!plan.ok()) return plan.status();
  const double seconds = watch.lap();
  const MeshHeader& header = (*plan)->header();
  const FillEstimate fill = estimate_fill(**plan, interruption);
  if (auto status = check_cancelled(interruption); !status.ok()) return status;
  return MeshEstimate{header.vertex_count, header.tet_count,   fill.bytes, seconds,
                      fill.seconds,        header.inside_guess};
}

absl::StatusOr<MeshEstimate> estimate_here(const MeshOptions& options,
                                           ProgressBar& bar,
                                           const Cancellation& interruption) {
  TaskPool pool(options.threads);
  absl::StatusOr<MeshEstimate> estimate = absl::UnknownError("not counted");
  pool.run([&] { estimate = estimate_counted(options, bar, interruption); });
  return estimate;
}

absl::StatusOr<MeshEstimate> estimate_on_server(const MeshOptions& options,
                                                ProgressBar& bar,
                                                const Cancellation& interruption) {
  const auto client = MeshClient::connect(options.server, options.channel);
  if (!client.ok()) return client.status();
  const auto request = prepare_request(**client, options, bar, interruption);
  if (!request.ok()) return request.status();
  bar.begin("counting");
  Stopwatch watch;
  const auto header = (*client)->estimate(request->message, interruption);
  if (!header.ok()) return header.status();
  const auto count = [](std::int64_t value) { return static_cast<std::uint64_t>(value); };
  return MeshEstimate{count(header->vertex_count()), count(header->tet_count()),
                      count(header->mesh_bytes()),   watch.lap(),
                      header->fill_seconds(),        header->inside_guess()};
}

std::string line_of(const std::string& input, const MeshEstimate& estimate) {
  return absl::StrFormat(
      "%s: %d vertices, %d tets, %.1f MB; counted in %.2f s, about %.2f s to make", input,
      estimate.vertices, estimate.tets, 1e-6 * static_cast<double>(estimate.bytes),
      estimate.count_seconds, estimate.fill_seconds);
}

std::string json_of(const MeshEstimate& estimate) {
  nlohmann::ordered_json json{{"vertices", estimate.vertices},
                              {"tets", estimate.tets},
                              {"bytes", estimate.bytes},
                              {"count_seconds", estimate.count_seconds},
                              {"fill_seconds", estimate.fill_seconds}};
  if (!estimate.inside_guess.empty()) json["inside_guess"] = estimate.inside_guess;
  return json.dump(2);
}

absl::Status run_estimate(const EstimateArguments& arguments,
                          const Cancellation& interruption) {
  absl::StatusOr<MeshOptions> options = understand_input(arguments.mesh);
  if (!options.ok()) return options.status();
  if (auto status = check_input(*options); !status.ok()) return status;
  const std::string input = options->input;
  const absl::StatusOr<PlacedArray> placed = PlacedArray::of(*options, interruption);
  if (!placed.ok()) return placed.status();
  absl::StatusOr<MeshEstimate> estimate = absl::UnknownError("not counted");
  {
    ProgressBar bar;
    estimate = options->server.empty() ? estimate_here(*options, bar, interruption)
                                       : estimate_on_server(*options, bar, interruption);
  }
  if (!estimate.ok()) return estimate.status();
  std::printf("%s\n", arguments.json ? json_of(*estimate).c_str()
                                     : for_terminal(line_of(input, *estimate)).c_str());
  if (!estimate->inside_guess.empty()) {
    std::fprintf(stderr, "%s\n",
                 lines_for_terminal(inside_note(estimate->inside_guess)).c_str());
  }
  return absl::OkStatus();
}

}  // namespace

Command add_estimate_command(CLI::App& app) {
  const auto arguments = std::make_shared<EstimateArguments>();
  app.footer(kEstimateExamples);
  describe_input(app, arguments->mesh);
  app.add_flag("--json", arguments->json,
               "Print JSON: vertices, tets, bytes, count_seconds and fill_seconds");
  return [arguments](const Cancellation& interruption) {
    return run_estimate(*arguments, interruption);
  };
}

}  // namespace tet
