// `tetstream info`: the grids of a .vdb file.
#include <cstdio>
#include <memory>

#include <CLI/CLI.hpp>
#include <absl/strings/str_format.h>
#include <nlohmann/json.hpp>

#include "client/command/command.h"
#include "client/library/read_grids.h"
#include "core/base/printable.h"

namespace tet {
namespace {

constexpr const char* kInfoExamples = R"(
Examples:
  tetstream info bunny.vdb
  tetstream info bunny.vdb --json | jq '.[].name'
)";

struct InfoOptions {
  std::string path;
  bool json = false;
  bool trust = false;
};

std::string extent_of(const VoxelBox& box) {
  if (box.empty()) return "empty";
  return absl::StrFormat("%d x %d x %d", std::int64_t{box.max.x} - box.min.x + 1,
                         std::int64_t{box.max.y} - box.min.y + 1,
                         std::int64_t{box.max.z} - box.min.z + 1);
}

constexpr const char* kRow = "%-16s %-8s %-11s %12s %14s %20s  %-6s  %s\n";

/// Whether its values can be given to the vertices of a mesh.
const char* field_of(const GridInfo& grid) {
  if (grid.field_components == 0) return "no";
  return grid.field_components == 1 ? "scalar" : "vector";
}

void print_table(const std::vector<GridInfo>& grids) {
  std::printf(kRow, "grid", "type", "class", "voxel size", "active voxels", "box", "field",
              "meshable");
  for (const GridInfo& grid : grids) {
    std::printf(
        kRow, for_terminal(grid.name).c_str(), for_terminal(grid.value_type).c_str(),
        for_terminal(grid.grid_class).c_str(), absl::StrFormat("%g", grid.voxel_size).c_str(),
        std::to_string(grid.active_voxels).c_str(), extent_of(grid.active_box).c_str(),
        field_of(grid),
        grid.not_meshable.empty() ? "yes" : for_terminal("no: " + grid.not_meshable).c_str());
    if (!grid.made_of.empty()) {
      std::printf("  of a surface: %s\n", for_terminal(grid.made_of).c_str());
    }
  }
}

nlohmann::ordered_json json_of(const VoxelCoord& voxel) { return {voxel.x, voxel.y, voxel.z}; }

nlohmann::ordered_json json_of(const GridInfo& grid) {
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
  if (!grid.active_box.empty()) {
    json["active_box"] = {{"min", json_of(grid.active_box.min)},
                          {"max", json_of(grid.active_box.max)}};
  }
  return json;
}

void print_json(const std::vector<GridInfo>& grids) {
  auto list = nlohmann::ordered_json::array();
  for (const GridInfo& grid : grids) list.push_back(json_of(grid));
  // Names come from files and need not be UTF-8.
  const auto lenient = nlohmann::ordered_json::error_handler_t::replace;
  constexpr bool kAscii = true;  // for a terminal: nothing in it acts
  std::printf("%s\n", list.dump(2, ' ', kAscii, lenient).c_str());
}

absl::Status run_info(const InfoOptions& options, const Cancellation& interruption) {
  const absl::StatusOr<std::vector<GridInfo>> grids = read_grid_list(
      options.path, options.trust ? FileTrust::kFull : FileTrust::kNone, interruption);
  if (!grids.ok()) return grids.status();
  options.json ? print_json(*grids) : print_table(*grids);
  return absl::OkStatus();
}

}  // namespace

Command add_info_command(CLI::App& app) {
  const auto options = std::make_shared<InfoOptions>();
  app.footer(kInfoExamples);
  app.add_option("FILE", options->path, "A .vdb file")->required();
  app.add_flag("--json", options->json, "As JSON, for programs");
  app.add_flag("--trust", options->trust, kTrustHelp);
  return
      [options](const Cancellation& interruption) { return run_info(*options, interruption); };
}

}  // namespace tet
