#include "core/files/transfer_files.h"

#include <filesystem>
#include <utility>

#include <absl/strings/ascii.h>
#include <absl/strings/str_cat.h>

#include "core/base/posix/atomic_file.h"
#include "core/files/read_vtu.h"
#include "core/files/write_data_vtu.h"

namespace tet {
namespace {

absl::Status check_is_vtu(const std::string& path) {
  const std::string ending =
      absl::AsciiStrToLower(std::filesystem::path(path).extension().string());
  if (ending == ".vtu") return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(path,
                   " does not end in .vtu, the format that meshes with arrays are read "
                   "from and written to"));
}

absl::Status check(const TransferFiles& files) {
  for (const std::string* path : {&files.from, &files.to, &files.output}) {
    if (auto status = check_is_vtu(*path); !status.ok()) return status;
  }
  return check_can_create(files.output);
}

void put_beside(std::vector<DataArray> made, std::vector<DataArray>& arrays) {
  for (DataArray& array : made) {
    std::erase_if(arrays, [&](const DataArray& other) { return other.name == array.name; });
    arrays.push_back(std::move(array));
  }
}

}  // namespace

absl::StatusOr<TransferReport> transfer_files(TaskPool& pool,
                                              const TransferFiles& files,
                                              const TransferOptions& options,
                                              const Cancellation& cancellation) {
  if (auto status = check(files); !status.ok()) return status;
  const absl::StatusOr<DataMesh> from = read_vtu(files.from);
  if (!from.ok()) return from.status();
  absl::StatusOr<DataMesh> to = read_vtu(files.to);
  if (!to.ok()) return to.status();
  absl::StatusOr<TransferResult> made = absl::UnknownError("not transferred");
  pool.run([&] { made = transfer(*from, *to, options, cancellation); });
  if (!made.ok()) return made.status();
  put_beside(std::move(made->point_data), to->point_data);
  put_beside(std::move(made->cell_data), to->cell_data);
  const WriteControl control{.cancellation = &cancellation, .progress = {}};
  if (auto status = write_data_vtu(files.output, *to, control); !status.ok()) return status;
  return TransferReport{.points = to->points.size(),
                        .tets = to->tets.size(),
                        .arrays = std::move(made->told),
                        .outside_points = made->outside_points,
                        .outside_cells = made->outside_cells,
                        .farthest = made->farthest,
                        .left_out = to->of_whole.left_out};
}

}  // namespace tet
