#include "core/plan/crease_labels.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include <absl/strings/escaping.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/mesh/crease_patches.h"
#include "core/mesh/face_counts.h"
#include "core/plan/check_face_regions.h"

namespace tet {
namespace {

/// A region's creases, by one of its labels; null where it has none.
const FaceRegion::Creases* creases_of(const FaceLabel& label, const MeshHeader& header) {
  if (label.kind != FaceKind::kRegion) return nullptr;
  const auto& regions = header.face_regions;
  const auto region =
      std::ranges::find(regions, name_in_request(label, header), &FaceRegion::name);
  return region == regions.end() || !region->creases ? nullptr : &*region->creases;
}

/// The faces of one label as patches, whose labels follow each other from `first_label` on.
struct DividedLabel {
  CreasePatches patches;
  std::size_t first_label = 0;
};

/// Enters labels one after the other, patches among them.
class RegionDivision {
 public:
  RegionDivision(const TetMesh& surface, const Cancellation& cancellation)
      : surface_(surface), cancellation_(cancellation) {}

  absl::Status add(std::uint16_t label);
  /// Writes labels and their numbers: into the mesh that they are of.
  void apply(TetMesh& surface) &&;

 private:
  void keep(const FaceLabel& label) { labels_.push_back(label); }
  absl::Status divide(std::uint16_t label, double angle_deg);

  const TetMesh& surface_;
  const Cancellation& cancellation_;
  std::vector<FaceLabel> labels_;
  std::vector<std::uint16_t> renumbered_;  // of each label before
  std::vector<DividedLabel> divided_;
};

absl::Status RegionDivision::add(std::uint16_t label) {
  const FaceLabel& before = surface_.header.face_labels[label];
  if (const auto* creases = creases_of(before, surface_.header)) {
    if (auto status = divide(label, creases->angle_deg); !status.ok()) return status;
    const CreasePatches& patches = divided_.back().patches;
    const bool all_in_patches =
        std::ranges::find(patches.patch, CreasePatches::kNone) == patches.patch.end();
    if (all_in_patches && patches.count > 0) {
      renumbered_.push_back(0);  // of no face
      return absl::OkStatus();
    }
  }
  renumbered_.push_back(static_cast<std::uint16_t>(labels_.size()));
  keep(before);
  return absl::OkStatus();
}

absl::Status RegionDivision::divide(std::uint16_t label, double angle_deg) {
  const auto& before = surface_.header.face_labels;
  CreasePatches patches = find_crease_patches(surface_, label, angle_deg, cancellation_);
  if (auto status = check_cancelled(cancellation_); !status.ok()) return status;
  // All labels that come behind, and this one itself, may stay.
  const std::size_t all = labels_.size() + patches.count + before.size() - label;
  if (all > kMaxFaceLabels) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "%s: creases of %g degrees divide '%s' into %d patches, which makes %d names of "
        "faces; the limit is %d. Use a larger angle, or have the region take less of the "
        "surface",
        kFaceRegionsField, angle_deg, absl::CHexEscape(before[label].name), patches.count, all,
        kMaxFaceLabels));
  }
  divided_.push_back({std::move(patches), labels_.size()});
  for (std::uint32_t i = 0; i < divided_.back().patches.count; ++i) {
    keep({absl::StrCat(before[label].name, ".", i + 1), FaceKind::kRegion, before[label].part});
  }
  return absl::OkStatus();
}

void RegionDivision::apply(TetMesh& surface) && {
  const std::span<std::byte> column = surface.face_labels.bytes();
  const auto store = [&](std::uint64_t face, std::size_t label) {
    const auto number = static_cast<std::uint16_t>(label);
    std::memcpy(column.data() + face * sizeof(number), &number, sizeof(number));
  };
  for (std::uint64_t i = 0; i < surface.header.face_count; ++i) {
    store(i, renumbered_[surface.face_label(i)]);
  }
  for (const auto& [patches, first_label] : divided_) {
    for (std::size_t i = 0; i < patches.faces.size(); ++i) {
      if (patches.patch[i] == CreasePatches::kNone) continue;
      store(patches.faces[i], first_label + patches.patch[i]);
    }
  }
  surface.header.face_labels = std::move(labels_);
}

}  // namespace

absl::Status divide_regions(TetMesh& surface, const Cancellation& cancellation) {
  RegionDivision division(surface, cancellation);
  const std::size_t labels = surface.header.face_labels.size();
  for (std::size_t label = 0; label < labels; ++label) {
    if (auto status = division.add(static_cast<std::uint16_t>(label)); !status.ok()) {
      return status;
    }
  }
  std::move(division).apply(surface);
  return check_part_labels(surface.header);
}

}  // namespace tet
