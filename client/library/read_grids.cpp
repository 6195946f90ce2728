#include "client/library/read_grids.h"

#include <utility>

#include "client/library/attached_image.h"
#include "core/base/posix/check_file.h"
#include "core/vdb/decoder/decode_file.h"
#include "core/vdb/openvdb/read_grid_file.h"
#include "core/vdb/plain/load_limits.h"

namespace tet {
namespace {

absl::StatusOr<SealedBlock> decode_here(FileRequest request, const Cancellation& interruption) {
  if (absl::Status s = check_file(request.path); !s.ok()) return s;
  const absl::StatusOr<AttachedImage> file = AttachedImage::of(request.path, interruption);
  if (!file.ok()) return file.status();
  request.path = file->path();
  return decode_once(request, {}, [&] { return interruption.requested(); });
}

/// Calls `read(reader)` of the file, or of what is joined of it.
template <class Read>
auto read_here(const std::string& path, const Cancellation& interruption, const Read& read)
    -> decltype(read(std::declval<const GridFileReader&>())) {
  const absl::StatusOr<AttachedImage> file = AttachedImage::of(path, interruption);
  if (!file.ok()) return file.status();
  return with_grid_file(file->path(), read);
}

absl::StatusOr<GridContents> values_here(const std::string& path,
                                         const std::string& grid_name,
                                         FileTrust trust,
                                         const Cancellation& interruption) {
  if (trust == FileTrust::kFull) {
    const absl::StatusOr<Volume> volume = read_volume(path, grid_name, trust, interruption);
    if (!volume.ok()) return volume.status();
    return GridContents{.values = values_of(*volume)};
  }
  const FileRequest request{DecodeTask::kValues, path, path, grid_name, LoadLimits{}.max_bytes};
  return contents_of(decode_here(request, interruption), request);
}

absl::StatusOr<GridContents> label_counts_here(const std::string& path,
                                               const std::string& grid_name,
                                               FileTrust trust,
                                               const Cancellation& interruption) {
  if (trust == FileTrust::kFull) {
    const absl::StatusOr<LabelVolume> labels =
        read_labels(path, grid_name, trust, interruption);
    if (!labels.ok()) return labels.status();
    GridContents contents;
    set_labels_of(*labels, contents);
    return contents;
  }
  const FileRequest request{DecodeTask::kLabelCounts, path, path, grid_name,
                            LoadLimits{}.max_bytes};
  return contents_of(decode_here(request, interruption), request);
}

}  // namespace

absl::StatusOr<Volume> read_volume(const std::string& path,
                                   const std::string& grid_name,
                                   FileTrust trust,
                                   const Cancellation& interruption) {
  if (trust == FileTrust::kFull) {
    return read_here(path, interruption,
                     [&](const GridFileReader& file) { return file.volume(grid_name); });
  }
  const FileRequest request{DecodeTask::kVolume, path, path, grid_name, LoadLimits{}.max_bytes};
  return volume_of(decode_here(request, interruption), request);
}

absl::StatusOr<Volume> read_field(const std::string& path,
                                  const std::string& grid_name,
                                  std::uint32_t component,
                                  FileTrust trust,
                                  const Cancellation& interruption) {
  if (trust == FileTrust::kFull) {
    return read_here(path, interruption, [&](const GridFileReader& file) {
      return file.field(grid_name, component);
    });
  }
  const FileRequest request{DecodeTask::kField,     path,     path, grid_name,
                            LoadLimits{}.max_bytes, component};
  return volume_of(decode_here(request, interruption), request);
}

absl::StatusOr<LabelVolume> read_labels(const std::string& path,
                                        const std::string& grid_name,
                                        FileTrust trust,
                                        const Cancellation& interruption) {
  if (trust == FileTrust::kFull) {
    return read_here(path, interruption,
                     [&](const GridFileReader& file) { return file.labels(grid_name); });
  }
  const FileRequest request{DecodeTask::kLabels, path, path, grid_name, LoadLimits{}.max_bytes};
  return labels_of(decode_here(request, interruption), request);
}

absl::StatusOr<std::vector<GridInfo>> read_grid_list(const std::string& path,
                                                     FileTrust trust,
                                                     const Cancellation& interruption) {
  if (trust == FileTrust::kFull) {
    return read_here(path, interruption,
                     [](const GridFileReader& file) { return file.list(); });
  }
  // What the walk tells needs no decoder. What it cannot tell, or open, one is asked for.
  const auto listed = read_here(
      path, interruption, [](const GridFileReader& file) { return file.list_by_walking(); });
  if (listed.ok() && *listed) return **listed;
  const FileRequest request{DecodeTask::kGridList, path, path, "", LoadLimits{}.max_bytes};
  return grid_list_of(decode_here(request, interruption), request);
}

absl::StatusOr<GridContents> read_contents(const std::string& path,
                                           const GridInfo& grid,
                                           FileTrust trust,
                                           const Cancellation& interruption) {
  if (!grid.not_meshable.empty()) return GridContents();
  absl::StatusOr<GridContents> told = values_here(path, grid.name, trust, interruption);
  if (absl::IsFailedPrecondition(told.status())) {
    return GridContents{.not_meshable = std::string(told.status().message())};
  }
  if (!told.ok() || !may_have_labels(grid)) return told;
  const auto labels = label_counts_here(path, grid.name, trust, interruption);
  if (absl::IsFailedPrecondition(labels.status())) return told;  // it is no segmentation
  if (!labels.ok()) return labels.status();
  told->label_count = labels->label_count;
  told->labels = labels->labels;
  return told;
}

std::vector<std::string> meshable_of(const std::vector<GridInfo>& grids) {
  std::vector<std::string> names;
  for (const GridInfo& grid : grids) {
    if (grid.not_meshable.empty()) names.push_back(grid.name);
  }
  return names;
}

}  // namespace tet
