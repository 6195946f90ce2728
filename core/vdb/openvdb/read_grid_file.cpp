#include "core/vdb/openvdb/read_grid_file.h"

#include <limits>
#include <utility>

#include <absl/strings/str_format.h>

#include "core/base/posix/check_file.h"
#include "core/vdb/plain/load_image_file.h"
#include "core/vdb/plain/plain_grid.h"
#include "core/vdb/walk/image_file.h"
#include "core/vdb/walk/plain_choice.h"
#include "core/vdb/walk/triangle_file.h"

namespace tet {
namespace {

/// Walks over the file, and checks what reading it takes unless that was done.
absl::StatusOr<VdbOutline> outline_of(
    const OpenGridFile& file,
    const LoadLimits& limits,
    const std::function<MemoryCharge(const VdbOutline&)>& charge_of) {
  constexpr std::uint64_t kAny = std::numeric_limits<std::uint64_t>::max();
  VdbOutline outline;
  const auto charge = [&](const VdbOutline& walked) {
    outline = walked;
    return charge_of(walked);
  };
  const absl::Status status = charge_file(file, charge, limits.walked ? kAny : limits.max_bytes,
                                          limits.walked ? kAny : limits.max_reading_bytes)
                                  .status();
  if (!status.ok()) return status;
  return outline;
}

absl::Status check_image(const OpenGridFile& file, const LoadLimits& limits, bool lists) {
  if (limits.walked) return absl::OkStatus();
  return charge_image(file, lists, limits.max_bytes, limits.max_reading_bytes).status();
}

/// Calls `load(part, limits)`, which need not walk over the file again if it was a .vdb file.
template <class Load>
auto load_with_openvdb(const FindOpenVdb& find,
                       LoadLimits limits,
                       bool walked,
                       const Load& load)
    -> decltype(load(std::declval<const OpenVdbPart&>(), limits)) {
  const absl::StatusOr<const OpenVdbPart*> part = find();
  if (!part.ok()) return part.status();
  limits.walked |= walked;
  return load(**part, limits);
}

absl::StatusOr<Volume> read_values(const OpenGridFile& file,
                                   const std::string& grid_name,
                                   GridUse use,
                                   std::uint32_t component,
                                   const LoadLimits& limits,
                                   const FindOpenVdb& find) {
  if (holds_image(file)) {
    if (absl::Status s = check_image(file, limits, false); !s.ok()) return s;
    return load_image_file(file, grid_name, use, component, limits);
  }
  const bool walks = !holds_triangles(file);
  if (walks) {
    const absl::StatusOr<VdbOutline> outline = outline_of(
        file, limits, [&](const VdbOutline& o) { return loading_charge(o, grid_name, use); });
    if (!outline.ok()) return outline.status();
    const auto plain = find_plain_grid(*outline, grid_name, use, component);
    if (plain) return read_plain_grid(file, *outline, *plain, use);
  }
  return load_with_openvdb(
      find, limits, walks, [&](const OpenVdbPart& part, const LoadLimits& l) {
        return use == GridUse::kField ? part.load_field(file, grid_name, component, l)
                                      : part.load_volume(file, grid_name, l);
      });
}

}  // namespace

absl::StatusOr<std::vector<GridInfo>> GridFileReader::list() const {
  if (holds_image(file_)) {
    if (absl::Status s = check_image(file_, limits_, true); !s.ok()) return s;
    return list_image_file(file_);
  }
  auto listed = list_by_walking();
  if (!listed.ok()) return listed.status();
  if (*listed) return **std::move(listed);
  return load_with_openvdb(
      find_openvdb_, limits_, !holds_triangles(file_),
      [&](const OpenVdbPart& part, const LoadLimits& l) { return part.list_grids(file_, l); });
}

absl::StatusOr<std::optional<std::vector<GridInfo>>> GridFileReader::list_by_walking() const {
  if (holds_image(file_) || holds_triangles(file_)) return std::nullopt;
  const absl::StatusOr<VdbOutline> outline = outline_of(file_, limits_, listing_charge);
  if (!outline.ok()) return outline.status();
  if (!are_plain_grids(*outline)) return std::nullopt;
  absl::StatusOr<std::vector<GridInfo>> grids = list_plain_grids(file_, *outline);
  if (!grids.ok()) return grids.status();
  return *std::move(grids);
}

absl::StatusOr<Volume> GridFileReader::volume(const std::string& grid_name) const {
  return read_values(file_, grid_name, GridUse::kSurface, 0, limits_, find_openvdb_);
}

absl::StatusOr<Volume> GridFileReader::field(const std::string& grid_name,
                                             std::uint32_t component) const {
  return read_values(file_, grid_name, GridUse::kField, component, limits_, find_openvdb_);
}

absl::StatusOr<LabelVolume> GridFileReader::labels(const std::string& grid_name) const {
  if (holds_image(file_)) {
    if (absl::Status s = check_image(file_, limits_, false); !s.ok()) return s;
    return load_label_file(file_, grid_name, limits_);
  }
  return load_with_openvdb(find_openvdb_, limits_, /*walked=*/false,
                           [&](const OpenVdbPart& part, const LoadLimits& limits) {
                             return part.load_labels(file_, grid_name, limits);
                           });
}

absl::StatusOr<File> open_grid_file(const std::string& path) {
  if (absl::Status s = check_file(path); !s.ok()) return s;
  absl::StatusOr<File> file = File::open(path, O_RDONLY, io_error);
  if (file.ok()) return file;
  return absl::InvalidArgumentError(
      absl::StrFormat("'%s' is not a readable VDB file: it cannot be opened", path));
}

}  // namespace tet
