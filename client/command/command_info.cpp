// `tetstream info`: the grids of a .vdb file, or what is in an image.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <nlohmann/json.hpp>

#include "client/command/command.h"
#include "client/library/read_grids.h"
#include "core/base/printable.h"
#include "core/volume/inside.h"

namespace tet {
namespace {

constexpr const char* kInfoExamples = R"(
Examples:
  tetstream info bunny.vdb
  tetstream info bunny.vdb --json | jq '.[].name'
  tetstream info scan.nii.gz               its voxels, where in the world they are, labels
  tetstream info smoke.vdb --no-values     what its header says, in no time

The values of float and double grids are read: their range, and the side of the surface that
is inside by the grid's class, or else by the values; docs/inside.md.
)";

struct InfoOptions {
  std::string path;
  bool json = false;
  bool trust = false;
  bool no_values = false;
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

/// How often a label is in an image.
struct LabelCount {
  std::int64_t label = 0;
  std::uint64_t voxels = 0;
};

/// An image of more different values than this is no segmentation to list.
constexpr std::size_t kMostLabels = 4096;

/// What the values of a grid tell.
struct GridValues {
  ValueRange range;
  InsideSide inside = InsideSide::kBelow;
  KindSource source = KindSource::kMaker;
};

struct KnownGrid {
  GridInfo info;
  std::optional<GridValues> values;  ///< of those that can be meshed, if they are read
  std::vector<LabelCount> labels;    ///< of an image of integers, if they are read
};

std::string range_of(const KnownGrid& grid) {
  if (!grid.values) return "";
  return absl::StrFormat("%g to %g", grid.values->range.min, grid.values->range.max);
}

std::string inside_of(const KnownGrid& grid) {
  if (!grid.values) return "";
  switch (grid.values->source) {
    case KindSource::kMaker:
    case KindSource::kClass:
      return side_name(grid.values->inside);
    case KindSource::kValues:
      return absl::StrCat(side_name(grid.values->inside), "?");
    case KindSource::kNobody:
      return "unclear";
  }
  return "";
}

constexpr const char* kRow = "%-16s %-8s %-11s %12s %14s %20s  %-6s  %-20s %10s  %-7s  %s\n";

/// As many labels as a screen has room for.
std::string labels_text(const std::vector<LabelCount>& labels) {
  constexpr std::size_t kShown = 40;
  std::string text = absl::StrFormat("%d labels (voxels):", labels.size());
  for (std::size_t i = 0; i < std::min(labels.size(), kShown); ++i) {
    absl::StrAppendFormat(&text, "%s %d (%d)", i == 0 ? "" : ",", labels[i].label,
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
    if (!known.labels.empty()) std::printf("  %s\n", labels_text(known.labels).c_str());
    if (!grid.made_of.empty()) {
      std::printf("  of a surface: %s\n", for_terminal(grid.made_of).c_str());
    }
  }
}

nlohmann::ordered_json json_of(const VoxelCoord& voxel) { return {voxel.x, voxel.y, voxel.z}; }

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
  if (!known.labels.empty()) {
    auto& labels = json["labels"] = nlohmann::ordered_json::array();
    for (const auto& [label, voxels] : known.labels) {
      labels.push_back({{"label", label}, {"voxels", voxels}});
    }
  }
  if (known.values) {
    const GridValues& values = *known.values;
    json["values"] = {{"min", values.range.min}, {"max", values.range.max}};
    json["inside"] =
        values.source == KindSource::kNobody ? "unclear" : side_name(values.inside);
    json["inside_is_guessed"] = values.source == KindSource::kValues;
  }
  if (!grid.active_box.empty()) {
    json["active_box"] = {{"min", json_of(grid.active_box.min)},
                          {"max", json_of(grid.active_box.max)}};
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

/// Counts an image's labels; one of too many different values has none.
absl::Status count_labels(const InfoOptions& options,
                          KnownGrid& grid,
                          const Cancellation& interruption) {
  const bool integers = grid.info.value_type.find("int") != std::string::npos;
  if (grid.info.grid_class != "image" || !integers || !grid.info.not_meshable.empty()) {
    return absl::OkStatus();
  }
  const absl::StatusOr<LabelVolume> labels =
      read_labels(options.path, grid.info.name, trust_of(options), interruption);
  if (absl::IsFailedPrecondition(labels.status())) return absl::OkStatus();
  if (!labels.ok()) return labels.status();
  if (labels->labels.size() > kMostLabels) return absl::OkStatus();
  for (std::size_t i = 0; i < labels->labels.size(); ++i) {
    grid.labels.push_back({labels->labels[i], labels->voxel_counts[i]});
  }
  return absl::OkStatus();
}

/// What cannot be read cannot be meshed, and the list says why.
absl::Status read_values(const InfoOptions& options,
                         KnownGrid& grid,
                         const Cancellation& interruption) {
  if (!grid.info.not_meshable.empty()) return absl::OkStatus();
  const absl::StatusOr<Volume> volume =
      read_volume(options.path, grid.info.name, trust_of(options), interruption);
  if (volume.ok()) {
    grid.values = {value_range(*volume), own_side(*volume), volume->kind_source};
    grid.info.background = volume->background;
  } else if (absl::IsFailedPrecondition(volume.status())) {
    grid.info.not_meshable = std::string(volume.status().message());
  } else {
    return volume.status();
  }
  return absl::OkStatus();
}

absl::StatusOr<std::vector<KnownGrid>> read_grids(const InfoOptions& options,
                                                  const Cancellation& interruption) {
  const absl::StatusOr<std::vector<GridInfo>> listed =
      read_grid_list(options.path, trust_of(options), interruption);
  if (!listed.ok()) return listed.status();
  std::vector<KnownGrid> grids;
  for (const GridInfo& info : *listed) {
    grids.push_back({info, {}, {}});
    if (options.no_values) continue;
    if (auto status = read_values(options, grids.back(), interruption); !status.ok()) {
      return status;
    }
    if (auto status = count_labels(options, grids.back(), interruption); !status.ok()) {
      return status;
    }
  }
  return grids;
}

absl::Status run_info(const InfoOptions& options, const Cancellation& interruption) {
  const absl::StatusOr<std::vector<KnownGrid>> grids = read_grids(options, interruption);
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
  return
      [options](const Cancellation& interruption) { return run_info(*options, interruption); };
}

}  // namespace tet
