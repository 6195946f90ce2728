#include "core/vdb/decoder/decode_file.h"

#include <absl/strings/str_format.h>

#include "core/base/failure_name.h"
#include "core/volume/flat_grid_contents.h"
#include "core/volume/flat_grid_list.h"
#include "core/volume/flat_label_volume.h"
#include "core/volume/flat_volume.h"

namespace tet {
namespace {

/// Our decoder does not write what cannot be read: whatever wrote this was not itself any more.
absl::Status bad_result(const FileRequest& request, const absl::Status& why) {
  if (absl::IsResourceExhausted(why) || absl::IsCancelled(why)) return why;
  return named_failure("DECODER_RESULT", absl::InvalidArgumentError(absl::StrFormat(
                                             "'%s' could not be decoded: %s", request.file_name,
                                             std::string(why.message()))));
}

}  // namespace

absl::StatusOr<Volume> volume_of(const absl::StatusOr<SealedBlock>& block,
                                 const FileRequest& request,
                                 const Cancellation& cancellation) {
  if (!block.ok()) return block.status();
  absl::StatusOr<Volume> volume =
      read_flat_volume(block->bytes(), request.max_bytes, cancellation);
  if (!volume.ok()) return bad_result(request, volume.status());
  if (has_inside(volume->kind) != (request.task == DecodeTask::kVolume)) {
    return bad_result(request, absl::InvalidArgumentError("it is not what was asked for"));
  }
  return volume;
}

absl::StatusOr<LabelVolume> labels_of(const absl::StatusOr<SealedBlock>& block,
                                      const FileRequest& request,
                                      const Cancellation& cancellation) {
  if (!block.ok()) return block.status();
  absl::StatusOr<LabelVolume> labels =
      read_flat_labels(block->bytes(), request.max_bytes, cancellation);
  if (!labels.ok()) return bad_result(request, labels.status());
  return labels;
}

absl::StatusOr<GridContents> contents_of(const absl::StatusOr<SealedBlock>& block,
                                         const FileRequest& request) {
  if (!block.ok()) return block.status();
  absl::StatusOr<GridContents> contents = read_flat_contents(block->bytes());
  if (!contents.ok()) return bad_result(request, contents.status());
  const bool is_asked_for = request.task == DecodeTask::kValues ? contents->values.has_value()
                                                                : contents->label_count > 0;
  if (is_asked_for) return contents;
  return bad_result(request, absl::InvalidArgumentError("it is not what was asked for"));
}

absl::StatusOr<std::vector<GridInfo>> grid_list_of(const absl::StatusOr<SealedBlock>& block,
                                                   const FileRequest& request) {
  if (!block.ok()) return block.status();
  absl::StatusOr<std::vector<GridInfo>> grids = read_flat_grid_list(block->bytes());
  if (!grids.ok()) return bad_result(request, grids.status());
  return grids;
}

}  // namespace tet
