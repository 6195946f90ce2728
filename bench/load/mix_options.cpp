#include "bench/load/mix_options.h"

#include <cstdint>
#include <fstream>
#include <memory>
#include <utility>

#include <CLI/CLI.hpp>
#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_split.h>
#include <absl/strings/strip.h>

#include "client/command/arguments/empty_values.h"
#include "client/command/arguments/mesh_input.h"
#include "client/library/wire_request.h"
#include "core/base/bare_option.h"

namespace tet::load {
namespace {

absl::StatusOr<std::string> store_grid(const std::string& grid,
                                       MeshClient& client,
                                       ProgressBar& bar,
                                       const Cancellation& interruption) {
  if (std::string name = stored_grid_name(grid); !name.empty()) return name;
  bar.begin("uploading", "B");
  const ClientProgress progress{.upload =
                                    [&](std::uint64_t done, std::uint64_t total) {
                                      bar.update(static_cast<double>(done),
                                                 static_cast<double>(total));
                                    },
                                .planning = {},
                                .tets = {}};
  return client.upload_file(grid, progress, interruption);
}

std::string label_of(const MixArguments& arguments, const std::string& grid) {
  const MeshRequest& request = arguments.request.request;
  std::string label = grid;
  for (const std::string& name : arguments.request.grids)
    absl::StrAppend(&label, " --grid ", name);
  if (request.iso) absl::StrAppendFormat(&label, " --iso %g", *request.iso);
  if (request.spacing) absl::StrAppendFormat(&label, " --spacing %g", *request.spacing);
  if (const auto levels = arguments.request.levels)
    absl::StrAppend(&label, " --levels ", *levels);
  if (arguments.request.preset != "default") {
    absl::StrAppend(&label, " --preset ", arguments.request.preset);
  }
  if (request.manifold) label += " --manifold";
  if (request.improve) label += " --improve";
  if (request.skip_statistics) label += " --skip-statistics";
  if (arguments.vary_iso) {
    absl::StrAppendFormat(&label, " --vary-iso %g %g", (*arguments.vary_iso)[0],
                          (*arguments.vary_iso)[1]);
  }
  if (arguments.fresh) label += " --fresh";
  if (arguments.job) label += " --job";
  if (arguments.skip_cache) label += " --skip-cache";
  return label;
}

absl::Status check(const MixArguments& arguments) {
  if (!(arguments.weight > 0)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("--weight %g is not positive", arguments.weight));
  }
  if (arguments.vary_iso && arguments.request.request.iso) {
    return absl::InvalidArgumentError("--iso and --vary-iso exclude each other");
  }
  return absl::OkStatus();
}

absl::StatusOr<MixEntry> prepare_entry(const MixArguments& arguments,
                                       const std::string& grid,
                                       MeshClient& client,
                                       ProgressBar& bar,
                                       const Cancellation& interruption) {
  absl::StatusOr<MeshRequest> request = understand_request(arguments.request);
  if (!request.ok()) return request.status();
  if (arguments.vary_iso) request->iso = (*arguments.vary_iso)[0];
  const auto name = store_grid(grid, client, bar, interruption);
  if (!name.ok()) return name.status();
  MixEntry entry;
  entry.label = label_of(arguments, grid);
  entry.weight = arguments.weight;
  entry.message = wire_request(*request, *name, arguments.request.grids);
  bar.begin("counting");
  const auto header = client.estimate(entry.message, interruption);
  if (!header.ok()) return header.status();
  entry.tet_count = header->tet_count();
  entry.kind = arguments.job ? RequestKind::kJob : RequestKind::kStream;
  entry.skip_cache = arguments.skip_cache;
  entry.fresh = arguments.fresh;
  if (entry.fresh) entry.message.set_spacing(header->canonical_request().spacing());
  if (arguments.vary_iso) entry.iso = {(*arguments.vary_iso)[0], (*arguments.vary_iso)[1]};
  return entry;
}

absl::Status parse_line(const std::string& line, MixArguments& arguments) {
  CLI::App app;
  app.set_help_flag();
  describe_mix(app, arguments);
  refuse_empty_values(app);
  try {
    const std::string empty =
        option_without_value(absl::StrSplit(line, absl::ByAnyChar(" \t"), absl::SkipEmpty()));
    if (!empty.empty()) return absl::InvalidArgumentError(no_value_message(empty));
    app.parse(line);
  } catch (const CLI::ParseError& error) {
    return absl::InvalidArgumentError(error.what());
  }
  if (arguments.grids.empty()) return absl::InvalidArgumentError("no grid");
  return check(arguments);
}

}  // namespace

void describe_mix(CLI::App& app, MixArguments& arguments) {
  app.add_option("GRID", arguments.grids,
                 "What to mesh: .vdb files, uploaded when the server lacks them, or digests of "
                 "stored ones");
  describe_request(app, arguments.request);
  app.add_flag("--skip-statistics", arguments.request.request.skip_statistics,
               "Ask for meshes without their quality and topology");
  app.add_option("--vary-iso", arguments.vary_iso, "Each request takes an iso value in between")
      ->type_name("LOW HIGH");
  app.add_flag("--fresh", arguments.fresh,
               "Ask for a mesh that the server has not planned before, each time");
  app.add_flag("--job", arguments.job,
               "Submit a batch job, wait for it and read its result, instead of a stream");
  app.add_flag("--skip-cache", arguments.skip_cache,
               "Have meshes made even where a job's result is stored");
  app.add_option("--weight", arguments.weight,
                 "How often, compared to the others of a mix [1]");
}

absl::StatusOr<std::vector<MixArguments>> read_mix_file(const std::string& path) {
  std::ifstream file(path);
  if (!file) return absl::NotFoundError(absl::StrCat(path, " cannot be opened"));
  std::vector<MixArguments> mix;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const absl::string_view text = absl::StripAsciiWhitespace(line);
    if (text.empty() || text.front() == '#') continue;
    const absl::Status status = parse_line(std::string(text), mix.emplace_back());
    if (!status.ok()) {
      return absl::InvalidArgumentError(
          absl::StrCat(path, ":", number, ": ", status.message()));
    }
  }
  if (mix.empty()) return absl::InvalidArgumentError(absl::StrCat(path, " has no requests"));
  return mix;
}

absl::StatusOr<RequestMix> prepare_mix(const std::vector<MixArguments>& arguments,
                                       MeshClient& client,
                                       ProgressBar& bar,
                                       const Cancellation& interruption) {
  std::vector<MixEntry> entries;
  const std::uint64_t fresh_from = draw_fresh_from();
  for (const MixArguments& some : arguments) {
    if (absl::Status status = check(some); !status.ok()) return status;
    for (const std::string& grid : some.grids) {
      absl::StatusOr<MixEntry> entry = prepare_entry(some, grid, client, bar, interruption);
      if (!entry.ok()) {
        return absl::Status(entry.status().code(),
                            absl::StrCat(grid, ": ", entry.status().message()));
      }
      if (entry->fresh) entry->fresh_from = fresh_from;
      entries.push_back(*std::move(entry));
    }
  }
  return RequestMix(std::move(entries));
}

}  // namespace tet::load
