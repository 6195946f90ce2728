// `tetstream info`: the grids of a .vdb file, or what is in an image, here or on a server.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <nlohmann/json.hpp>

#include "client/command/arguments/mesh_input.h"
#include "client/command/arguments/server_options.h"
#include "client/command/command.h"
#include "client/library/mesh_client.h"
#include "client/library/read_grids.h"
#include "core/base/printable.h"
#include "core/volume/grid_contents.h"
#include "core/volume/inside.h"
#include "proto/convert/grid_info_message.h"

namespace tet {
namespace {

constexpr const char* kInfoExamples = R"(
Examples:
  tetstream info bunny.vdb
  tetstream info bunny.vdb --json | jq '.[].name'
  tetstream info scan.nii.gz               its voxels, where in the world they are, labels
  tetstream info smoke.vdb --no-values     what its header says, in no time
  tetstream info scan.nii.gz --server HOST:PORT   what a server makes of it; the file is uploaded

The values of float and double grids are read: their range, and the side of the surface that
is inside by the grid's class, or else by the values; docs/inside.md.
)";

struct InfoOptions {
  std::string path;
  bool json = false;
  bool trust = false;
  bool no_values = false;
  ServerArguments server = {};
};

FileTrust trust_of(const InfoOptions& options) {
  return options.trust ? FileTrust::kFull : FileTrust::kNone;
}

std::string extent_of(const VoxelBox& box) {
  if (box.empty()) return "empty";
  return absl::StrFormat("%d x %d x %d", std::int64_t{box.max.x} - box.min.x + 1,
                         std::int64_t{box.max.y} - box.min.y + 1,
                         std::int64_t{box.max.z} - box.min.z + 1);
}

struct KnownGrid {
  GridInfo info;
  GridContents contents;  ///< if they are read

  /// Where there are more labels than are listed it is no segmentation to show.
  bool shows_labels() const noexcept {
    return contents.label_count > 0 && contents.label_count == contents.labels.size();
  }
};

std::string range_of(const KnownGrid& grid) {
  if (!grid.contents.values) return "";
  return absl::StrFormat("%g to %g", grid.contents.values->range.min,
                         grid.contents.values->range.max);
}

std::string inside_of(const KnownGrid& grid) {
  if (!grid.contents.values) return "";
  switch (grid.contents.values->source) {
    case KindSource::kMaker:
    case KindSource::kClass:
      return side_name(grid.contents.values->inside);
    case KindSource::kValues:
      return absl::StrCat(side_name(grid.contents.values->inside), "?");
    case KindSource::kNobody:
      return "unclear";
  }
  return "";
}

constexpr const char* kRow = "%-16s %-8s %-11s %12s %14s %20s  %-6s  %-20s %10s  %-7s  %s\n";

/// As many labels as a screen has room for.
std::string labels_text(const std::vector<LabelExtent>& labels) {
  constexpr std::size_t kShown = 40;
  std::string text = absl::StrFormat("%d labels (voxels):", labels.size());
  for (std::size_t i = 0; i < std::min(labels.size(), kShown); ++i) {
    absl::StrAppendFormat(&text, "%s %d (%d)", i == 0 ? "" : ",", labels[i].value,
                          labels[i].voxels);
  }
  if (labels.size() > kShown) text += ", ...; --json has all";
  text += "; `mesh --labels all` meshes each";
  return text;
}

/// Whether its values can be given to the vertices of a mesh.
const char* field_of(const GridInfo& grid) {
  if (grid.field_components == 0) return "no";
  return grid.field_components == 1 ? "scalar" : "vector";
}

void print_table(const std::vector<KnownGrid>& grids) {
  std::printf(kRow, "grid", "type", "class", "voxel size", "active voxels", "box", "field",
              "values", "background", "inside", "meshable");
  for (const KnownGrid& known : grids) {
    const GridInfo& grid = known.info;
    std::printf(
        kRow, for_terminal(grid.name).c_str(), for_terminal(grid.value_type).c_str(),
        for_terminal(grid.grid_class).c_str(), absl::StrFormat("%g", grid.voxel_size).c_str(),
        std::to_string(grid.active_voxels).c_str(), extent_of(grid.active_box).c_str(),
        field_of(grid), range_of(known).c_str(), absl::StrFormat("%g", grid.background).c_str(),
        inside_of(known).c_str(),
        grid.not_meshable.empty() ? "yes" : for_terminal("no: " + grid.not_meshable).c_str());
    if (!grid.place.empty()) std::printf("  %s\n", for_terminal(grid.place).c_str());
    if (known.shows_labels()) {
      std::printf("  %s\n", labels_text(known.contents.labels).c_str());
    }
    if (!grid.made_of.empty()) {
      std::printf("  of a surface: %s\n", for_terminal(grid.made_of).c_str());
    }
  }
}

nlohmann::ordered_json json_of(const VoxelCoord& voxel) { return {voxel.x, voxel.y, voxel.z}; }

nlohmann::ordered_json json_of(const VoxelBox& box) {
  return {{"min", json_of(box.min)}, {"max", json_of(box.max)}};
}

nlohmann::ordered_json json_of(const KnownGrid& known) {
  const GridInfo& grid = known.info;
  nlohmann::ordered_json json{{"name", grid.name},
                              {"value_type", grid.value_type},
                              {"class", grid.grid_class},
                              {"voxel_size", grid.voxel_size},
                              {"active_voxels", grid.active_voxels},
                              {"background", grid.background},
                              {"field_components", grid.field_components},
                              {"meshable", grid.not_meshable.empty()}};
  if (!grid.not_meshable.empty()) json["not_meshable"] = grid.not_meshable;
  if (!grid.made_of.empty()) json["made_of"] = grid.made_of;
  if (!grid.place.empty()) json["place"] = grid.place;
  if (known.shows_labels()) {
    auto& labels = json["labels"] = nlohmann::ordered_json::array();
    for (const auto& [label, voxels, box] : known.contents.labels) {
      labels.push_back({{"label", label}, {"voxels", voxels}, {"box", json_of(box)}});
    }
  }
  if (known.contents.values) {
    const GridValues& values = *known.contents.values;
    json["values"] = {{"min", values.range.min}, {"max", values.range.max}};
    json["inside"] =
        values.source == KindSource::kNobody ? "unclear" : side_name(values.inside);
    json["inside_is_guessed"] = values.source == KindSource::kValues;
  }
  if (!grid.active_box.empty()) {
    json["active_box"] = json_of(grid.active_box);
  }
  return json;
}

void print_json(const std::vector<KnownGrid>& grids) {
  auto list = nlohmann::ordered_json::array();
  for (const KnownGrid& grid : grids) list.push_back(json_of(grid));
  // Names come from files and need not be UTF-8.
  const auto lenient = nlohmann::ordered_json::error_handler_t::replace;
  constexpr bool kAscii = true;  // for a terminal: nothing in it acts
  std::printf("%s\n", list.dump(2, ' ', kAscii, lenient).c_str());
}

/// What cannot be read cannot be meshed, and the list says why.
void tell_contents(GridContents contents, KnownGrid& grid) {
  if (!contents.not_meshable.empty()) grid.info.not_meshable = contents.not_meshable;
  if (contents.values) grid.info.background = contents.values->background;
  grid.contents = std::move(contents);
}

absl::StatusOr<std::vector<KnownGrid>> read_grids_here(const InfoOptions& options,
                                                       const Cancellation& interruption) {
  const absl::StatusOr<std::vector<GridInfo>> listed =
      read_grid_list(options.path, trust_of(options), interruption);
  if (!listed.ok()) return listed.status();
  std::vector<KnownGrid> grids;
  for (const GridInfo& info : *listed) {
    grids.push_back({info, {}});
    if (options.no_values) continue;
    auto contents = read_contents(options.path, info, trust_of(options), interruption);
    if (!contents.ok()) return contents.status();
    tell_contents(*std::move(contents), grids.back());
  }
  return grids;
}

/// Uploads the file unless the server has it, and asks.
absl::StatusOr<std::vector<KnownGrid>> ask_for_grids(const InfoOptions& options,
                                                     const Cancellation& interruption) {
  const MeshInput input{options.path, {}, {}};
  if (auto status = check_mesh_input(input); !status.ok()) return status;
  const absl::StatusOr<ChannelOptions> channel = understand_server(options.server);
  if (!channel.ok()) return channel.status();
  const auto client = MeshClient::connect(options.server.address, *channel);
  if (!client.ok()) return client.status();
  const UploadWatch nobody{[](std::uint64_t, std::uint64_t) {}, [](const auto&) {}};
  const auto name = upload_input(**client, input, nobody, interruption);
  if (!name.ok()) return name.status();
  const auto file = (*client)->grid_info(
      *name, interruption, options.no_values ? GridDetail::kHeader : GridDetail::kValues);
  if (!file.ok()) return file.status();
  std::vector<KnownGrid> grids;
  for (const v1::GridInfo& message : file->grids()) {
    grids.push_back({grid_info_of(message), {}});
    auto contents = contents_of(message);
    if (!contents.ok()) return contents.status();
    tell_contents(*std::move(contents), grids.back());
  }
  return grids;
}

absl::Status run_info(const InfoOptions& options, const Cancellation& interruption) {
  const bool is_here = options.server.address.empty();
  if (options.trust && !is_here) {
    return absl::InvalidArgumentError(
        "--trust is about a file that is read here: leave --trust or --server out");
  }
  const absl::StatusOr<std::vector<KnownGrid>> grids =
      is_here ? read_grids_here(options, interruption) : ask_for_grids(options, interruption);
  if (!grids.ok()) return grids.status();
  options.json ? print_json(*grids) : print_table(*grids);
  return absl::OkStatus();
}

}  // namespace

Command add_info_command(CLI::App& app) {
  const auto options = std::make_shared<InfoOptions>();
  app.footer(kInfoExamples);
  app.add_option("FILE", options->path,
                 "A .vdb file, or an image: .nii, .nrrd, .mha, .vti, .npy")
      ->required();
  app.add_flag("--json", options->json, "As JSON, for programs");
  app.add_flag("--no-values", options->no_values,
               "Leave out what takes reading the values: their range, and the inside");
  app.add_flag("--trust", options->trust, kTrustHelp);
  describe_server(app, options->server);
  return
      [options](const Cancellation& interruption) { return run_info(*options, interruption); };
}

}  // namespace tet
