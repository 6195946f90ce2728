#include "core/vdb/decoder/file_request.h"

#include <algorithm>
#include <utility>

#include <absl/strings/str_format.h>

#include "core/base/posix/check_file.h"
#include "core/base/posix/file.h"
#include "core/vdb/walk/charge_file.h"
#include "core/vdb/walk/image_file.h"
#include "core/vdb/walk/plain_choice.h"
#include "core/vdb/walk/triangle_file.h"
#include "core/volume/grid_info.h"

namespace tet {
namespace {

/// What reading any file may take beside its charge: the stream's buffers, a heap's gaps, a
/// decompressor's tables.
constexpr std::uint64_t kLeastWorkingBytes = std::uint64_t{64} << 20;
/// The texts of 4096 grids, and then some.
constexpr std::uint64_t kLeastResultBytes = std::uint64_t{16} << 20;
/// A constant brick takes twice the bytes in a flat volume.
constexpr std::uint64_t kFlatFactor = 2;
/// While a volume is made there is OpenVDB's tree too, and its columns grow.
constexpr std::uint64_t kReadingFactor = 3;

constexpr std::chrono::milliseconds kLeastTime{2000};
/// By the clock a file may take this many times its processor time: a machine that is busy with
/// other things is no fault of the file.
constexpr int kClockFactor = 10;
/// A tenth of what a slow machine reads a second, of a file and of what it unpacks to.
constexpr std::uint64_t kFileBytesPerSecond = 10'000'000;
constexpr std::uint64_t kMemoryBytesPerSecond = 50'000'000;

GridUse use_of(DecodeTask task) {
  switch (task) {
    case DecodeTask::kField:
      return GridUse::kField;
    case DecodeTask::kLabels:
    case DecodeTask::kLabelCounts:
      return GridUse::kLabels;
    default:
      return GridUse::kSurface;
  }
}

/// What the file takes, if that is not too much; and whether it takes OpenVDB.
absl::StatusOr<MemoryCharge> charge_of(const FileRequest& request,
                                       const OpenGridFile& file,
                                       const std::function<bool()>& cancelled,
                                       bool& needs_openvdb) {
  if (holds_image(file)) {
    needs_openvdb = false;
    return charge_image(file, request.task == DecodeTask::kGridList, request.max_bytes,
                        kReadingFactor * request.max_bytes);
  }
  if (holds_triangles(file)) {
    return charge_triangles(file, request.max_bytes, kReadingFactor * request.max_bytes);
  }
  if (request.task == DecodeTask::kGridList) {
    const auto charge = [&](const VdbOutline& outline) {
      needs_openvdb = !are_plain_grids(outline);
      return listing_charge(outline);
    };
    return charge_file(file, charge, request.max_bytes, request.max_bytes, cancelled);
  }
  const auto charge = [&](const VdbOutline& outline) {
    needs_openvdb =
        !find_plain_grid(outline, request.grid_name, use_of(request.task), request.component);
    return loading_charge(outline, request.grid_name, use_of(request.task));
  };
  return charge_file(file, charge, request.max_bytes, kReadingFactor * request.max_bytes,
                     cancelled);
}

/// Returns how long a processor may work on the file.
std::chrono::milliseconds time_for(std::int64_t file_bytes, const MemoryCharge& charge) {
  const std::uint64_t seconds = static_cast<std::uint64_t>(file_bytes) / kFileBytesPerSecond +
                                (charge.reading + charge.unpacked) / kMemoryBytesPerSecond;
  return kLeastTime + std::chrono::seconds(seconds);
}

DecodeLimits limits_of(const MemoryCharge& charge, std::chrono::milliseconds time) {
  DecodeLimits limits;
  limits.result_bytes = kFlatFactor * charge.volume + kLeastResultBytes;
  limits.working_bytes = charge.reading + kLeastWorkingBytes;
  limits.cpu_seconds =
      static_cast<std::uint64_t>(std::chrono::ceil<std::chrono::seconds>(time).count());
  return limits;
}

}  // namespace

absl::StatusOr<CheckedFile> check_request(const FileRequest& request,
                                          std::chrono::milliseconds max_time,
                                          const std::function<bool()>& cancelled) {
  if (absl::Status s = check_file(request.path); !s.ok()) {
    return absl::Status(s.code(), absl::StrFormat("'%s' cannot be read", request.file_name));
  }
  if (request.grid_name.size() > kMaxGridNameBytes) {
    return absl::NotFoundError(
        absl::StrFormat("no grid has a name of %d bytes; the limit is %d",
                        request.grid_name.size(), kMaxGridNameBytes));
  }
  CheckedFile checked;
  absl::StatusOr<File> opened = File::open(request.path, O_RDONLY, io_error);
  const auto size = opened.ok() ? opened->size() : opened.status();
  if (!size.ok()) {
    return absl::PermissionDeniedError(
        absl::StrFormat("'%s' cannot be opened", request.file_name));
  }
  checked.file = (*std::move(opened)).take_descriptor();
  const auto file_bytes = static_cast<std::int64_t>(*size);
  const OpenGridFile file{checked.file.number(), file_bytes, request.file_name};
  bool needs_openvdb = true;
  const absl::StatusOr<MemoryCharge> charge =
      charge_of(request, file, cancelled, needs_openvdb);
  if (!charge.ok()) return charge.status();
  std::chrono::milliseconds time = time_for(file_bytes, *charge);
  if (holds_triangles(file)) time += kConvertingTime;
  checked.limit = std::min(kClockFactor * time, max_time);
  checked.order = {request.task,      limits_of(*charge, std::min(time, max_time)),
                   file_bytes,        request.file_name,
                   request.grid_name, request.component,
                   needs_openvdb};
  return checked;
}

}  // namespace tet
