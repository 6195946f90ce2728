// `tetstream sample`: phi, its slope and fields at points of a text file.
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_replace.h>

#include "client/command/arguments/field_options.h"
#include "client/command/arguments/mesh_arguments.h"
#include "client/command/arguments/mesh_input.h"
#include "client/command/arguments/option_rules.h"
#include "client/command/arguments/output_places.h"
#include "client/command/arguments/request_options.h"
#include "client/command/arguments/server_options.h"
#include "client/command/command.h"
#include "client/command/mesh/mesh_report.h"
#include "client/command/mesh/prepare_request.h"
#include "client/command/mesh/read_shape.h"
#include "client/library/mesh_client.h"
#include "client/library/read_grids.h"
#include "client/library/text_file.h"
#include "core/base/parallel.h"
#include "core/base/posix/atomic_file.h"
#include "core/base/printable.h"
#include "core/files/read_points.h"
#include "core/plan/sample_points.h"

namespace tet {
namespace {

constexpr const char* kSampleExamples = R"(
Examples:
  tetstream sample bunny.vdb points.txt -o samples.csv
      phi (negative inside) and its slope along x, y and z at each point; docs/transfer.md
  tetstream sample fire.vdb points.txt -o samples.csv --grid density --field temperature
      and the values of other grids
  tetstream sample part.json points.txt -o samples.csv
      of a scene
  tetstream sample bunny.vdb points.txt -o samples.csv --server localhost:7447
      by a server, which is sent the volume if it does not have it: the same bytes
)";

struct SampleCommand {
  MeshOptions options;
  RequestArguments request;
  ServerArguments server;
  std::string points;
};

std::vector<std::string> files_read(const SampleCommand& command, const MeshOptions& options) {
  std::vector<std::string> files{options.input, command.points};
  for (const VertexField& field : options.request.fields) files.push_back(field.file);
  return files;
}

absl::StatusOr<MeshOptions> understand(const SampleCommand& command) {
  MeshOptions options = command.options;
  absl::StatusOr<MeshRequest> request = understand_request(command.request);
  if (!request.ok()) return request.status();
  options.request = *std::move(request);
  options.grids = command.request.grids;
  options.server = command.server.address;
  absl::StatusOr<ChannelOptions> channel = understand_server(command.server);
  if (!channel.ok()) return channel.status();
  options.channel = *std::move(channel);
  const MeshInput input{options.input, options.grids, options.surface};
  absl::Status status = check_features(
      features_of(options.request, input).add(Feature::kPoints), option_names(options.request));
  if (status.ok()) status = check_mesh_input(input);
  if (status.ok()) status = check_field_files(options.request.fields, options.input);
  if (status.ok()) status = check_trust(options);
  if (status.ok()) status = check_can_create(options.output);
  if (status.ok()) status = check_takes_no_place(options.output, files_read(command, options));
  if (!status.ok()) return status;
  return options;
}

/// A name as a column of a .csv has it.
std::string csv_name(const std::string& name) {
  return absl::StrCat("\"", absl::StrReplaceAll(name, {{"\"", "\"\""}}), "\"");
}

std::string csv_of(const std::vector<WorldPoint>& points, const PointSamples& samples) {
  std::string text = "x,y,z,phi,phi_x,phi_y,phi_z";
  for (const FieldArray& array : samples.arrays) {
    for (std::uint32_t c = 0; c < array.components; ++c) {
      const std::string suffix = array.components == 1 ? "" : absl::StrCat("_", c);
      absl::StrAppend(&text, ",", csv_name(array.name + suffix));
    }
  }
  text += "\n";
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& [x, y, z] = points[i];
    const double* const slope = &samples.slopes[3 * i];
    absl::StrAppendFormat(&text, "%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g", x, y, z,
                          samples.phi[i], slope[0], slope[1], slope[2]);
    for (std::size_t k = 0; k < samples.width; ++k) {
      absl::StrAppendFormat(&text, ",%.9g", samples.fields[i * samples.width + k]);
    }
    text += "\n";
  }
  return text;
}

absl::StatusOr<PointSamples> sample_read(const MeshOptions& options,
                                         const std::vector<WorldPoint>& points,
                                         ProgressBar& bar,
                                         const Cancellation& interruption) {
  absl::StatusOr<ReadShape> shape = read_shape(options, bar, interruption);
  if (!shape.ok()) return shape.status();
  const absl::StatusOr<MeshRequest> request = read_request(options, interruption);
  if (!request.ok()) return request.status();
  return sample_points(shape->shape, *request, points, interruption);
}

absl::StatusOr<PointSamples> sample_here(const MeshOptions& options,
                                         const std::vector<WorldPoint>& points,
                                         ProgressBar& bar,
                                         const Cancellation& interruption) {
  TaskPool pool(options.threads);
  absl::StatusOr<PointSamples> samples = absl::UnknownError("not sampled");
  pool.run([&] { samples = sample_read(options, points, bar, interruption); });
  return samples;
}

absl::StatusOr<PointSamples> sample_on_server(const MeshOptions& options,
                                              const std::vector<WorldPoint>& points,
                                              ProgressBar& bar,
                                              const Cancellation& interruption) {
  const auto client = MeshClient::connect(options.server, options.channel);
  if (!client.ok()) return client.status();
  const auto request = prepare_request(**client, options, bar, interruption);
  if (!request.ok()) return request.status();
  bar.begin("sampling", "points");
  const auto tell = [&](std::uint64_t done, std::uint64_t total) {
    bar.update(static_cast<double>(done), static_cast<double>(total));
  };
  return (*client)->sample_points(request->message, points, tell, interruption);
}

absl::Status run_sample(const SampleCommand& command, const Cancellation& interruption) {
  const absl::StatusOr<MeshOptions> options = understand(command);
  if (!options.ok()) return options.status();
  const absl::StatusOr<std::string> text = read_text_file(command.points, interruption);
  if (!text.ok()) return text.status();
  const auto points = read_points(*text);
  if (!points.ok()) return about(command.points, points.status());
  absl::StatusOr<PointSamples> samples = absl::UnknownError("not sampled");
  {
    ProgressBar bar;
    samples = options->server.empty() ? sample_here(*options, *points, bar, interruption)
                                      : sample_on_server(*options, *points, bar, interruption);
  }
  if (!samples.ok()) return samples.status();
  const std::string csv = csv_of(*points, *samples);
  if (auto status = write_text_file(options->output, csv); !status.ok()) return status;
  std::printf("%s: %zu points\n", for_terminal(options->output).c_str(), points->size());
  if (!samples->inside_guess.empty()) {
    std::fprintf(stderr, "%s\n",
                 lines_for_terminal(inside_note(samples->inside_guess)).c_str());
  }
  return absl::OkStatus();
}

}  // namespace

Command add_sample_command(CLI::App& app) {
  const auto command = std::make_shared<SampleCommand>();
  MeshOptions& options = command->options;
  app.footer(kSampleExamples);
  app.add_option("INPUT", options.input,
                 "A .vdb volume, a closed .obj, .stl or .ply surface, or a .json scene")
      ->required();
  app.add_option("POINTS", command->points, "A text file: three numbers a line")->required();
  app.add_option("-o,--output", options.output, "The .csv file: a line for each point")
      ->required();
  app.add_option("--grid", command->request.grids, "Grid of the .vdb [its only meshable one]")
      ->type_name("NAME")
      ->allow_extra_args(false)
      ->expected(1);
  app.add_option("--iso", command->request.request.iso,
                 "Value of the surface [0; 0.5 for fog volumes]");
  app.add_option("--inside", command->request.inside,
                 "Which side of the iso value is inside: above or below: docs/inside.md")
      ->check(CLI::IsMember({"above", "below"}));
  app.add_option("--field", command->request.fields, kFieldHelp)
      ->type_name(kFieldType)
      ->allow_extra_args(false);
  describe_surface(app, options.surface);
  app.add_option("--threads", options.threads, "Threads of this process [every core]")
      ->check(CLI::NonNegativeNumber);
  app.add_flag("--trust", options.trust, kTrustHelp);
  describe_server(app, command->server);
  return [command](const Cancellation& interruption) {
    return run_sample(*command, interruption);
  };
}

}  // namespace tet
