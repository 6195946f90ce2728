#include "client/command/mesh/label_report.h"

#include <cstddef>
#include <utility>
#include <vector>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "client/command/mesh/measure_labels.h"
#include "core/plan/labelled/label_numbers.h"

namespace tet {
namespace {

/// A label that keeps less than this of its voxels' volume is told of: its kernel rounds off
/// what is thin.
constexpr double kMuchLost = 0.5;

bool is_lost(const MeasuredLabel& label,
             const std::vector<double>& voxel_volumes,
             std::size_t number) {
  if (label.tets == 0) return true;
  return number < voxel_volumes.size() && label.volume < kMuchLost * voxel_volumes[number];
}

std::string what_is_left(const MeasuredLabel& label,
                         const std::vector<double>& voxel_volumes,
                         std::size_t number) {
  if (label.tets == 0) return " is lost: the mesh has none of it";
  return absl::StrFormat(" has %.3g of the volume of its voxels, %.4g",
                         label.volume / voxel_volumes[number], voxel_volumes[number]);
}

}  // namespace

std::string title_of(const MeshLabel& label) {
  return label.name.empty() ? absl::StrCat(label.value)
                            : absl::StrFormat("%d (%s)", label.value, label.name);
}

std::vector<double> voxel_volumes_of(const Shape& shape, const MeshRequest& request) {
  const auto labels = labels_of(shape);
  if (labels == nullptr || !request.labels) return {};
  const auto numbers = number_labels({labels->labels}, *request.labels);
  return numbers.ok() ? voxel_volumes_of(*labels, *numbers) : std::vector<double>();
}

nlohmann::ordered_json labels_json(const MadeMesh& made) {
  auto labels = nlohmann::ordered_json::array();
  const std::vector<MeasuredLabel> measured = measure_labels(made.mesh);
  const std::vector<std::uint64_t> parts = count_label_parts(made.mesh);
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const MeshLabel& label = made.mesh.header.labels[i];
    labels.push_back({{"value", label.value},
                      {"name", label.name},
                      {"tets", measured[i].tets},
                      {"volume", measured[i].volume},
                      {"parts", parts[i]}});
    if (i < made.voxel_volumes.size()) labels.back()["voxel_volume"] = made.voxel_volumes[i];
  }
  return labels;
}

std::string lost_labels_warning(const MadeMesh& made, LabelOrigin origin) {
  constexpr std::size_t kShown = 8;
  if (made.mesh.header.box) return "";
  std::string text;
  std::size_t lost = 0;
  const std::vector<MeasuredLabel> measured = measure_labels(made.mesh);
  for (std::size_t i = 0; i < measured.size(); ++i) {
    if (!is_lost(measured[i], made.voxel_volumes, i)) continue;
    if (++lost > kShown) continue;
    absl::StrAppend(&text, text.empty() ? "" : "\n", "warning: label ",
                    title_of(made.mesh.header.labels[i]),
                    what_is_left(measured[i], made.voxel_volumes, i));
  }
  if (lost == 0) return "";
  if (lost > kShown) absl::StrAppendFormat(&text, "\nwarning: and %d more", lost - kShown);
  return absl::StrCat(
      text, origin == LabelOrigin::kVoxels
                ? "\nwarning: --smooth thin, --smooth 0 or a smaller --spacing keep more"
                : "\nwarning: it lies within others, or is too small for the --spacing");
}

}  // namespace tet
