#include "client/library/read_grids.h"

#include "core/vdb/check_file.h"
#include "core/vdb/decode_file.h"
#include "core/vdb/load.h"

namespace tet {
namespace {

absl::StatusOr<SealedBlock> decode_here(const FileRequest& request,
                                        const Cancellation& interruption) {
  if (absl::Status s = check_file(request.path); !s.ok()) return s;
  return decode_once(request, {}, [&] { return interruption.requested(); });
}

}  // namespace

absl::StatusOr<Volume> read_volume(const std::string& path,
                                   const std::string& grid_name,
                                   FileTrust trust,
                                   const Cancellation& interruption) {
  if (trust == FileTrust::kFull) return load_volume(path, grid_name);
  const FileRequest request{DecodeTask::kVolume, path, path, grid_name, LoadLimits{}.max_bytes};
  return volume_of(decode_here(request, interruption), request);
}

absl::StatusOr<Volume> read_field(const std::string& path,
                                  const std::string& grid_name,
                                  std::uint32_t component,
                                  FileTrust trust,
                                  const Cancellation& interruption) {
  if (trust == FileTrust::kFull) return load_field(path, grid_name, component);
  const FileRequest request{DecodeTask::kField,     path,     path, grid_name,
                            LoadLimits{}.max_bytes, component};
  return volume_of(decode_here(request, interruption), request);
}

absl::StatusOr<std::vector<GridInfo>> read_grid_list(const std::string& path,
                                                     FileTrust trust,
                                                     const Cancellation& interruption) {
  if (trust == FileTrust::kFull) return list_grids(path);
  const FileRequest request{DecodeTask::kGridList, path, path, "", LoadLimits{}.max_bytes};
  return grid_list_of(decode_here(request, interruption), request);
}

std::vector<std::string> meshable_of(const std::vector<GridInfo>& grids) {
  std::vector<std::string> names;
  for (const GridInfo& grid : grids) {
    if (grid.not_meshable.empty()) names.push_back(grid.name);
  }
  return names;
}

}  // namespace tet
