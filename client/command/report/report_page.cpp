#include "client/command/report/report_page.h"

#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <nlohmann/json.hpp>

#include "client/command/report/report_charts.h"

namespace tet {
namespace {

using ParsedJson = nlohmann::json;

constexpr const char* kStyle = R"(
:root { color-scheme: light dark; --ink: #1d2433; --soft: #67718a; --line: #d5dae5;
        --bar: #2f6fb2; --bad: #c0392b; --far: #b7791f; --paper: #fff; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e6e9f0; --soft: #98a2b8; --line: #39414f; --bar: #6aa7e6; --bad: #ff7b6b;
          --far: #f0b44c; --paper: #14181f; } }
body { font: 15px/1.5 system-ui, sans-serif; color: var(--ink); background: var(--paper);
       max-width: 44rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.5rem; overflow-wrap: anywhere; } h2 { font-size: 1.1rem; margin-top: 2rem; }
table { border-collapse: collapse; width: 100%; } td, th { padding: .2rem .6rem .2rem 0;
       border-bottom: 1px solid var(--line); text-align: left; vertical-align: top; }
td { font-variant-numeric: tabular-nums; } th { font-weight: 500; color: var(--soft); }
.bars { width: 100%; } .bars rect { fill: var(--bar); }
svg text { font: 11px system-ui, sans-serif; fill: var(--soft); }
.places { display: flex; flex-wrap: wrap; gap: 1rem; } figure { margin: 0; }
figcaption { color: var(--soft); font-size: .85rem; }
.frame { fill: none; stroke: var(--line); }
.bad { fill: var(--bad); } .far { fill: var(--far); }
)";

/// A value within a report, if it is there; never another kind of value than is asked for.
const ParsedJson* find(const ParsedJson& json, const std::string& path) {
  const ParsedJson::json_pointer pointer(path);
  return json.contains(pointer) ? &json.at(pointer) : nullptr;
}

std::optional<double> number_at(const ParsedJson& json, const std::string& path) {
  const ParsedJson* const found = find(json, path);
  if (found == nullptr || !found->is_number()) return std::nullopt;
  return found->get<double>();
}

/// Counts of a histogram; nothing where one of them is no count.
std::vector<double> counts_at(const ParsedJson& json, const std::string& path) {
  constexpr std::size_t kMostBins = 4096;
  const ParsedJson* const found = find(json, path);
  if (found == nullptr || !found->is_array() || found->size() > kMostBins) return {};
  std::vector<double> counts;
  for (const ParsedJson& count : *found) {
    if (!count.is_number_unsigned()) return {};
    counts.push_back(count.get<double>());
  }
  return counts;
}

std::optional<std::array<double, 3>> place_at(const ParsedJson& json, const std::string& path) {
  const ParsedJson* const found = find(json, path);
  if (found == nullptr || !found->is_array() || found->size() != 3) return std::nullopt;
  std::array<double, 3> place{};
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(*found)[i].is_number()) return std::nullopt;
    place[i] = (*found)[i].get<double>();
  }
  return place;
}

/// Rows of a table, those of which something is known.
class Table {
 public:
  void row(const std::string& name, const std::string& value) {
    absl::StrAppend(&rows_, "<tr><th>", html_text(name), "</th><td>", html_text(value),
                    "</td></tr>\n");
  }
  void number(const ParsedJson& json, const std::string& name, const std::string& path) {
    if (const auto found = number_at(json, path)) row(name, absl::StrFormat("%.10g", *found));
  }
  /// Two numbers; the second one in spacings.
  void distance(const ParsedJson& json, const std::string& name, const std::string& path) {
    const auto world = number_at(json, path), spacings = number_at(json, path + "_spacings");
    if (!world || !spacings) return;
    row(name, absl::StrFormat("%.4g (%.3g spacings)", *world, *spacings));
  }
  std::string text() const {
    return rows_.empty() ? "" : absl::StrCat("<table>", rows_, "</table>\n");
  }

 private:
  std::string rows_;
};

std::string section(const char* title, const std::string& content) {
  return content.empty() ? "" : absl::StrCat("<h2>", title, "</h2>\n", content);
}

std::string counts_table(const ParsedJson& report) {
  Table table;
  table.number(report, "vertices", "/vertices");
  table.number(report, "tets", "/tets");
  table.number(report, "spacing", "/spacing");
  table.number(report, "volume", "/volume");
  table.number(report, "smallest dihedral angle, degrees", "/min_dihedral_deg");
  table.number(report, "largest dihedral angle, degrees", "/max_dihedral_deg");
  table.number(report, "tets that are not positive", "/shapes/not_positive");
  table.number(report, "parts of the boundary", "/boundary/components");
  table.number(report, "its Euler characteristic", "/boundary/euler_characteristic");
  table.number(report, "edges that are no manifold", "/boundary/non_manifold_edges");
  table.number(report, "vertices that are no manifold", "/boundary/non_manifold_vertices");
  table.number(report, "seconds", "/seconds");
  return table.text();
}

std::string fidelity_table(const ParsedJson& fidelity) {
  Table table;
  table.distance(fidelity, "Hausdorff distance, sampled", "/hausdorff");
  for (const auto& [key, name] : {std::pair("/mesh_to_surface", "mesh to surface"),
                                  std::pair("/surface_to_mesh", "surface to mesh")}) {
    table.distance(fidelity, absl::StrCat(name, ", largest"), absl::StrCat(key, "/max"));
    table.distance(fidelity, absl::StrCat(name, ", rms"), absl::StrCat(key, "/rms"));
  }
  table.number(fidelity, "volume of the mesh", "/mesh_volume");
  table.number(fidelity, "volume that phi encloses", "/enclosed_volume");
  if (const auto error = number_at(fidelity, "/volume_error")) {
    table.row("volume error", absl::StrFormat("%+.3g %%", 100 * *error));
  }
  table.number(fidelity, "area of the mesh's surface", "/mesh_area");
  table.number(fidelity, "area of the true surface", "/surface_area");
  return table.text();
}

/// A name that came from a file.
std::string name_of_part(const ParsedJson& part) {
  const ParsedJson* const name = find(part, "/name");
  return name != nullptr && name->is_string() ? name->get<std::string>() : "?";
}

std::string fidelity_section(const ParsedJson& report) {
  std::string text;
  if (const ParsedJson* const fidelity = find(report, "/fidelity"))
    text += fidelity_table(*fidelity);
  const ParsedJson* const parts = find(report, "/parts");
  if (parts != nullptr && parts->is_array()) {
    for (const ParsedJson& part : *parts) {
      const ParsedJson* const fidelity = find(part, "/fidelity");
      if (fidelity == nullptr) continue;
      absl::StrAppend(&text, "<h3>", html_text(name_of_part(part)), "</h3>\n",
                      fidelity_table(*fidelity));
    }
  }
  const ParsedJson* const missing = find(report, "/fidelity_missing");
  if (missing != nullptr && missing->is_string()) {
    absl::StrAppend(&text, "<p>Not measured: ", html_text(missing->get<std::string>()),
                    "</p>\n");
  }
  return section("How true the surface is", text);
}

std::string ratio_section(const ParsedJson& report, const char* title, const std::string& key) {
  const std::string path = "/shapes/" + key;
  BarChart chart{.counts = counts_at(report, path + "/histogram")};
  if (chart.counts.empty()) return "";
  Table table;
  table.number(report, "smallest", path + "/min");
  table.number(report, "mean", path + "/mean");
  table.number(report, "largest", path + "/max");
  return section(title, draw_bars(chart) + table.text());
}

std::string sizes_section(const ParsedJson& report) {
  const std::string path = "/shapes/edge_lengths";
  std::vector<double> counts = counts_at(report, path + "/histogram");
  const auto first = number_at(report, path + "/first_bin_spacings");
  const auto per_octave = number_at(report, path + "/bins_per_octave");
  if (counts.empty() || !first || !per_octave || !(*first > 0) || !(*per_octave > 0)) return "";
  double low = std::log2(*first);
  // Empty ends say nothing.
  std::size_t begin = 0;
  while (begin + 1 < counts.size() && counts[begin] == 0) ++begin;
  while (counts.size() > begin + 1 && counts.back() == 0) counts.pop_back();
  counts.erase(counts.begin(), counts.begin() + static_cast<std::ptrdiff_t>(begin));
  low += static_cast<double>(begin) / *per_octave;
  const double high = low + static_cast<double>(counts.size()) / *per_octave;
  Table table;
  table.number(report, "shortest edge, world units", path + "/min");
  table.number(report, "longest edge, world units", path + "/max");
  return section(
      "Sizes: lengths of edges, in spacings",
      draw_bars({.counts = std::move(counts), .low = low, .high = high, .octaves = true}) +
          table.text());
}

void mark_farthest(const ParsedJson& fidelity, PlaceChart& chart) {
  for (const auto& [key, name] :
       {std::pair("/mesh_to_surface", "the mesh is the farthest from the surface"),
        std::pair("/surface_to_mesh", "the surface is the farthest from the mesh")}) {
    if (const auto at = place_at(fidelity, absl::StrCat(key, "/at"))) {
      chart.marks.push_back({*at, name, "far"});
    }
  }
}

std::string places_section(const ParsedJson& report) {
  const auto min = place_at(report, "/bounds/min"), max = place_at(report, "/bounds/max");
  const ParsedJson* const worst = find(report, "/shapes/worst");
  if (!min || !max || worst == nullptr || !worst->is_array()) return "";
  PlaceChart chart{.min = *min, .max = *max, .marks = {}};
  std::string rows;
  for (const ParsedJson& tet : *worst) {
    const auto at = place_at(tet, "/at");
    const auto number = number_at(tet, "/tet"), ratio = number_at(tet, "/scaled_jacobian");
    if (!at || !number || !ratio) continue;
    const auto& [x, y, z] = *at;
    chart.marks.push_back(
        {*at, absl::StrFormat("tet %.0f: scaled Jacobian %.4g", *number, *ratio), "bad"});
    absl::StrAppendFormat(&rows, "<tr><td>%.0f</td><td>%.4g</td><td>%.6g %.6g %.6g</td></tr>\n",
                          *number, *ratio, x, y, z);
  }
  if (const ParsedJson* const fidelity = find(report, "/fidelity"))
    mark_farthest(*fidelity, chart);
  return section("Where the worst tets are",
                 absl::StrCat(draw_places(chart),
                              "<table><tr><th>tet</th><th>scaled Jacobian</th><th>place</th>"
                              "</tr>\n",
                              rows, "</table>\n"));
}

}  // namespace

absl::StatusOr<std::string> report_page(const std::string& report, const std::string& title) {
  const ParsedJson json = ParsedJson::parse(report, nullptr, false);
  const bool is_report =
      json.is_object() && number_at(json, "/tets") && number_at(json, "/vertices");
  if (!is_report) {
    return absl::InvalidArgumentError(
        "it is not what `tetstream mesh --report` writes: a JSON object with the numbers "
        "`vertices` and `tets`");
  }
  const std::string heading = html_text(title);
  return absl::StrCat(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>",
      heading, "</title><style>", kStyle, "</style></head>\n<body><h1>", heading, "</h1>\n",
      counts_table(json), fidelity_section(json),
      section("Dihedral angles, degrees",
              draw_bars({.counts = counts_at(json, "/dihedral_histogram"), .high = 180})),
      ratio_section(json, "Scaled Jacobian", "scaled_jacobian"),
      ratio_section(json, "Radius ratio", "radius_ratio"),
      ratio_section(json, "Edge ratio", "edge_ratio"), sizes_section(json),
      places_section(json), "</body></html>\n");
}

}  // namespace tet
