#include "core/vdb/decoder/decode_order.h"

#include <cerrno>
#include <cstring>
#include <malloc.h>
#include <new>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/base/failure_name.h"
#include "core/base/parallel.h"
#include "core/base/posix/transfer.h"
#include "core/vdb/decoder/idle_threads.h"
#include "core/vdb/decoder/sealed_block.h"
#include "core/vdb/openvdb/read_grid_file.h"
#include "core/volume/flat_grid_contents.h"
#include "core/volume/flat_grid_list.h"
#include "core/volume/flat_label_volume.h"
#include "core/volume/flat_volume.h"

namespace tet {
namespace {

bool openvdb_is_prepared = false;  // a copy of the process has what the process had

absl::Status write_into(int result, std::span<const std::byte> bytes) {
  if (write_all(result, bytes)) return absl::OkStatus();
  return absl::ResourceExhaustedError(
      absl::StrCat("there is no memory for the result: ", std::strerror(errno)));
}

absl::Status check_size(std::uint64_t size, const DecodeLimits& limits) {
  if (size <= limits.result_bytes) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrFormat(
      "what was decoded takes %d bytes and the limit is %d", size, limits.result_bytes));
}

/// In the sandbox, where nothing can be loaded.
absl::StatusOr<const OpenVdbPart*> prepared_openvdb() {
  if (openvdb_is_prepared) return openvdb_part();
  return absl::FailedPreconditionError("the file has changed while it was read");
}

absl::Status write_result(const DecodeOrder& order, int file, const ByteSink& sink) {
  const OpenGridFile source{file, order.file_bytes, order.file_name};
  LoadLimits limits;
  limits.walked = true;  // by whoever ordered this
  limits.max_reading_bytes = order.limits.working_bytes;
  const GridFileReader reader(source, limits, prepared_openvdb);
  if (order.task == DecodeTask::kGridList) {
    const absl::StatusOr<std::vector<GridInfo>> grids = reader.list();
    return grids.ok() ? write_flat_grid_list(*grids, sink) : grids.status();
  }
  if (order.task == DecodeTask::kLabels) {
    const absl::StatusOr<LabelVolume> labels = reader.labels(order.grid_name);
    if (!labels.ok()) return labels.status();
    if (absl::Status s = check_size(flat_label_bytes(*labels), order.limits); !s.ok()) return s;
    return write_flat_labels(*labels, sink);
  }
  if (order.task == DecodeTask::kLabelCounts) {
    const absl::StatusOr<LabelVolume> labels = reader.labels(order.grid_name);
    if (!labels.ok()) return labels.status();
    GridContents contents;
    set_labels_of(*labels, contents);
    return write_flat_contents(contents, sink);
  }
  const absl::StatusOr<Volume> volume = order.task == DecodeTask::kField
                                            ? reader.field(order.grid_name, order.component)
                                            : reader.volume(order.grid_name);
  if (!volume.ok()) return volume.status();
  if (order.task == DecodeTask::kValues) {
    return write_flat_contents({.values = values_of(*volume)}, sink);
  }
  if (absl::Status s = check_size(flat_volume_bytes(*volume), order.limits); !s.ok()) return s;
  return write_flat_volume(*volume, sink);
}

}  // namespace

void prepare_to_carry_out() {
  ::mallopt(M_PERTURB, 0xFF);  // what is allocated is filled with the opposite of this
  stay_in_one_thread();
  for_each_index(2, [](std::size_t) {});
}

absl::Status prepare_openvdb() {
  if (openvdb_is_prepared) return absl::OkStatus();
  const absl::StatusOr<const OpenVdbPart*> part = openvdb_part();
  if (!part.ok()) return part.status();
  (*part)->prepare_for_sandbox();
  openvdb_is_prepared = true;
  // A copy of the process has no other thread, and would wait for ever for what one of them
  // holds.
  return await_idle_threads();
}

absl::Status carry_out(const DecodeOrder& order, int file, int result) {
  try {
    const absl::Status status =
        write_result(order, file, [&](auto bytes) { return write_into(result, bytes); });
    return status.ok() ? seal_memory(result) : status;
  } catch (const std::bad_alloc&) {
    return named_failure("DECODER_MEMORY",
                         absl::InvalidArgumentError(absl::StrFormat(
                             "'%s' takes more memory than a decoder has", order.file_name)));
  }
}

}  // namespace tet
