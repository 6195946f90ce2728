#include "tetstream/labels.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "client/library/api/labelled_array.h"
#include "client/library/api/labels_impl.h"
#include "client/library/api/to_public.h"
#include "client/library/api/volume_impl.h"
#include "client/library/api/work.h"
#include "client/library/label_table.h"
#include "client/library/read_grids.h"
#include "client/library/text_file.h"
#include "core/image/write_labels.h"
#include "core/plan/joined/joined_plan.h"
#include "core/volume/check_transform.h"

namespace tetstream {
namespace {

Result<Labels> public_labels(absl::StatusOr<tet::LabelVolume> volume) {
  if (!volume.ok()) return to_public(volume.status());
  return Labels(std::make_shared<const Labels::Impl>(
      Labels::Impl{std::make_shared<const tet::LabelVolume>(*std::move(volume))}));
}

absl::StatusOr<std::vector<tet::LabelName>> names_in(const std::string& path) {
  const absl::StatusOr<std::string> text = tet::read_text_file(path);
  if (!text.ok()) return text.status();
  absl::StatusOr<std::vector<tet::LabelName>> names = tet::parse_label_table(*text);
  if (!names.ok()) return tet::about(path, names.status());
  return names;
}

}  // namespace

Labels::Labels(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}

Result<Labels> Labels::from_voxels(const LabelArray& labels) {
  return guarded([&] { return public_labels(labels_of_array(labels)); });
}

Result<Labels> Labels::from_file(const std::string& path, const VdbOptions& options) {
  return guarded([&] {
    const auto trust = options.trusted ? tet::FileTrust::kFull : tet::FileTrust::kNone;
    return public_labels(tet::read_labels(path, options.grid, trust, tet::Cancellation()));
  });
}

Result<Labels> Labels::from_level_sets(const std::vector<Volume>& volumes) {
  if (volumes.empty() || volumes.size() > tet::kMaxMeshParts) {
    return Status{StatusCode::kInvalidArgument, "there are " + std::to_string(volumes.size()) +
                                                    " level sets; labels are made of 1 to " +
                                                    std::to_string(tet::kMaxMeshParts)};
  }
  Labels::Impl impl;
  for (const Volume& volume : volumes) {
    const auto& core = volume.impl().components.front();
    if (!tet::has_inside(core->kind)) {
      return Status{StatusCode::kFailedPrecondition,
                    "level set " + std::to_string(impl.level_sets.size() + 1) +
                        " has no inside: it is of VolumeKind::kValues"};
    }
    impl.level_sets.push_back(core);
  }
  return Labels(std::make_shared<const Labels::Impl>(std::move(impl)));
}

std::vector<LabelCount> Labels::counts() const {
  if (impl_->volume == nullptr) {
    std::vector<LabelCount> counts(impl_->level_sets.size());
    for (std::size_t i = 0; i < counts.size(); ++i) {
      counts[i].value = static_cast<std::int64_t>(i + 1);
    }
    return counts;
  }
  const tet::LabelVolume& volume = *impl_->volume;
  std::vector<LabelCount> counts;
  for (std::size_t i = 0; i < volume.labels.size(); ++i) {
    counts.push_back({volume.labels[i], volume.voxel_counts[i]});
  }
  return counts;
}

std::array<double, 3> Labels::voxel_edges() const noexcept {
  return tet::voxel_edges(impl_->volume != nullptr ? impl_->volume->transform
                                                   : impl_->level_sets.front()->transform);
}

Status Labels::write_nrrd(const std::string& path) const {
  if (impl_->volume == nullptr) {
    return {StatusCode::kFailedPrecondition,
            "level sets are no image: write each volume as a .vdb file"};
  }
  return guarded([&] { return to_public(tet::write_labels(*impl_->volume, path)); });
}

Result<std::vector<MeshLabel>> read_label_names(const std::string& path) {
  return guarded([&]() -> Result<std::vector<MeshLabel>> {
    auto names = names_in(path);
    if (!names.ok()) return to_public(names.status());
    std::vector<MeshLabel> labels;
    for (tet::LabelName& name : *names) labels.push_back({name.value, std::move(name.name)});
    return labels;
  });
}

}  // namespace tetstream
