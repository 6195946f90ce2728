#include "tetstream/labels.h"

#include <cstddef>
#include <utility>

#include "client/library/api/labelled_array.h"
#include "client/library/api/labels_impl.h"
#include "client/library/api/to_public.h"
#include "client/library/api/work.h"
#include "client/library/label_table.h"
#include "client/library/read_grids.h"
#include "client/library/text_file.h"
#include "core/image/write_labels.h"
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

std::vector<LabelCount> Labels::counts() const {
  const tet::LabelVolume& volume = *impl_->volume;
  std::vector<LabelCount> counts;
  for (std::size_t i = 0; i < volume.labels.size(); ++i) {
    counts.push_back({volume.labels[i], volume.voxel_counts[i]});
  }
  return counts;
}

std::array<double, 3> Labels::voxel_edges() const noexcept {
  return tet::voxel_edges(impl_->volume->transform);
}

Status Labels::write_nrrd(const std::string& path) const {
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
