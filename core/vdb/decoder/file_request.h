// A file that somebody wants decoded: looked at first, then ordered.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

#include <absl/status/statusor.h>

#include "core/base/posix/descriptor.h"
#include "core/vdb/decoder/decoder_protocol.h"

namespace tet {

struct FileRequest {
  DecodeTask task = DecodeTask::kVolume;
  std::string path;
  std::string file_name;        ///< what messages call it: never a path of the server's
  std::string grid_name;        ///< empty takes the only one that will do
  std::uint64_t max_bytes = 0;  ///< of the volume in memory; of the trees for a grid list
  std::uint32_t component = 0;  ///< of a field
};

/// An open file and what may be spent on it.
struct CheckedFile {
  Descriptor file;
  DecodeOrder order;
  std::chrono::milliseconds limit;
};

/// Opens the file, walks over all of it without OpenVDB, and works out what reading it may
/// take: never more than `max_time`. Errors: those of check_file and charge_file, kCancelled
/// where `cancelled` says so among them; kNotFound (a name that no grid can have).
absl::StatusOr<CheckedFile> check_request(const FileRequest& request,
                                          std::chrono::milliseconds max_time,
                                          const std::function<bool()>& cancelled = nullptr);

}  // namespace tet
