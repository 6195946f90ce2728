#include "core/vdb/openvdb/load.h"

#include <algorithm>
#include <cstddef>
#include <exception>
#include <ios>
#include <new>
#include <type_traits>
#include <utility>

#include <absl/status/status.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_join.h>

#include "core/base/failure_name.h"
#include "core/base/posix/check_file.h"
#include "core/base/posix/file.h"
#include "core/vdb/openvdb/copy_grid.h"
#include "core/vdb/openvdb/copy_labels.h"
#include "core/vdb/openvdb/surface_grid.h"
#include "core/vdb/openvdb/vdb_file.h"
#include "core/vdb/openvdb/vdb_transform.h"
#include "core/vdb/plain/conversion_report.h"
#include "core/vdb/plain/grid_facts.h"
#include "core/vdb/plain/load_image_file.h"
#include "core/vdb/walk/image_file.h"
#include "core/vdb/walk/tree_type.h"
#include "core/vdb/walk/triangle_file.h"

namespace tet {
namespace {

/// Puts what the error is about in front of its message.
absl::Status told_of(const std::string& what, const absl::Status& error) {
  return {error.code(), absl::StrCat(what, ": ", error.message())};
}

absl::Status bad_file(const std::string& path, std::string_view why) {
  return absl::InvalidArgumentError(
      absl::StrFormat("'%s' is not a readable VDB file: %s", path, why));
}

/// Walks over the file and checks what it takes, unless the caller has.
template <class Charge>
absl::Status check_bytes(const OpenGridFile& file,
                         const LoadLimits& limits,
                         const Charge& charge) {
  if (limits.walked) return absl::OkStatus();
  return charge_file(file, charge, limits.max_bytes, limits.max_reading_bytes).status();
}

absl::Status check_image(const OpenGridFile& file, const LoadLimits& limits, bool lists) {
  if (limits.walked) return absl::OkStatus();
  return charge_image(file, lists, limits.max_bytes, limits.max_reading_bytes).status();
}

/// Calls `read(file)`; what OpenVDB throws becomes a status.
template <class Read>
std::invoke_result_t<Read, VdbFile&> with_file(const OpenGridFile& source, const Read& read) {
  try {
    VdbFile file(source.descriptor, source.size_bytes);
    return read(file);
  } catch (const std::ios_base::failure&) {
    return bad_file(source.name, "it ends early; it is truncated or corrupt");
  } catch (const std::bad_alloc&) {
    return named_failure(
        "DECODER_MEMORY",
        bad_file(source.name, "it claims more data than there is memory; it may be corrupt"));
  } catch (const std::exception& error) {
    return bad_file(source.name, error.what());
  }
}

/// Calls `read(open file)`.
template <class Read>
std::invoke_result_t<Read, OpenGridFile> with_path(const std::string& path, const Read& read) {
  if (absl::Status s = check_file(path); !s.ok()) return s;
  const absl::StatusOr<File> file = File::open(path, O_RDONLY, io_error);
  const auto size = file.ok() ? file->size() : file.status();
  if (!size.ok()) return bad_file(path, "it cannot be opened");
  return read(
      OpenGridFile{file->descriptor().number(), static_cast<std::int64_t>(*size), path});
}

std::string value_type(const openvdb::GridBase& grid) {
  const TreeType* const type = find_tree_type(grid.type());
  const bool points = type != nullptr && type->leaves == LeafLayout::kPoints;
  return points ? "points" : grid.valueType();
}

float background(const openvdb::GridBase& grid) {
  if (grid.isType<openvdb::FloatGrid>()) {
    return static_cast<const openvdb::FloatGrid&>(grid).background();
  }
  if (grid.isType<openvdb::DoubleGrid>()) {
    return static_cast<float>(static_cast<const openvdb::DoubleGrid&>(grid).background());
  }
  return 0;
}

VoxelBox active_box(const openvdb::GridBase& grid) {
  const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
  if (box.empty()) return {};
  return {{box.min().x(), box.min().y(), box.min().z()},
          {box.max().x(), box.max().y(), box.max().z()}};
}

std::string made_of(const openvdb::GridBase& grid) {
  std::vector<std::pair<std::string, std::string>> texts;
  for (auto entry = grid.beginMeta(); entry != grid.endMeta(); ++entry) {
    if (!entry->first.starts_with(kSurfaceMetadata)) continue;
    if (entry->second->typeName() != openvdb::StringMetadata::staticTypeName()) continue;
    texts.emplace_back(entry->first, entry->second->str());
  }
  return surface_text(texts);
}

GridInfo describe(const openvdb::GridBase& grid, std::string name) {
  GridInfo info;
  info.name = std::move(name);
  info.value_type = value_type(grid);
  info.grid_class = openvdb::GridBase::gridClassToString(grid.getGridClass());
  info.voxel_size = grid.voxelSize().x();
  if (const auto transform = voxel_transform(grid.transform()); transform.ok()) {
    info.voxel_size = transform->voxel_size;
    info.place = describe_voxels(*transform);
  }
  info.active_voxels = grid.activeVoxelCount();
  info.active_box = active_box(grid);
  info.background = background(grid);
  info.not_meshable = std::string(check_meshable(grid).message());
  if (info.not_meshable.empty() && grid.empty()) info.not_meshable = "it is empty";
  info.field_components = field_components(grid);
  info.made_of = made_of(grid);
  return info;
}

GridInfo describe(VdbFile& file, std::size_t i) {
  file.read_topology(i);
  return describe(file.grid(i), file.grid_name(i));
}

std::string names_of(const VdbFile& file) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < file.grid_count(); ++i) {
    names.push_back(absl::StrCat("'", file.grid_name(i), "'"));
  }
  return absl::StrJoin(names, ", ");
}

absl::StatusOr<std::size_t> find_named(const VdbFile& file, const std::string& name) {
  for (std::size_t i = 0; i < file.grid_count(); ++i) {
    if (file.grid_name(i) == name) return i;
  }
  return absl::NotFoundError(
      absl::StrFormat("there is no grid '%s'; the file has %s", name, names_of(file)));
}

/// What a grid is read for, and how: the grids that will do, and what is made of one.
struct Reading {
  GridUse use = GridUse::kSurface;
  std::uint32_t component = 0;  ///< of a field

  const char* verb() const {
    if (use == GridUse::kLabels) return "be a segmentation";
    return use == GridUse::kSurface ? "be meshed" : "be a field";
  }
  absl::Status check(const openvdb::GridBase& grid) const {
    if (use == GridUse::kLabels) return check_labels(grid);
    return use == GridUse::kSurface ? check_meshable(grid) : check_field(grid);
  }
  absl::StatusOr<Volume> copy(const openvdb::GridBase& grid) const {
    return use == GridUse::kSurface ? copy_grid(grid) : copy_field(grid, component);
  }
  /// Why the grid will not do, its values apart; empty when it will.
  std::string refusal(VdbFile& file, std::size_t i) const {
    if (use == GridUse::kSurface) return describe(file, i).not_meshable;
    return std::string(check(file.grid(i)).message());
  }
};

/// The only grid that will do.
absl::StatusOr<std::size_t> find_only(VdbFile& file, const Reading& reading) {
  if (file.grid_count() == 1) return 0;
  std::vector<std::size_t> fitting;
  std::vector<std::string> names, refusals;
  const auto is_real = [&](std::size_t i) { return has_real_values(file.grid(i)); };
  for (std::size_t i = 0; i < file.grid_count(); ++i) {
    const std::string refusal = reading.refusal(file, i);
    if (refusal.empty()) {
      fitting.push_back(i);
      names.push_back(absl::StrCat("'", file.grid_name(i), "'"));
    } else {
      refusals.push_back(absl::StrFormat("'%s': %s", file.grid_name(i), refusal));
    }
  }
  if (fitting.size() == 1) return fitting.front();
  // Flags and ids beside it do not make the one density or level set less clear.
  if (std::ranges::count_if(fitting, is_real) == 1) {
    return *std::ranges::find_if(fitting, is_real);
  }
  if (fitting.empty()) {
    return absl::FailedPreconditionError(absl::StrFormat(
        "none of its grids can %s: %s", reading.verb(), absl::StrJoin(refusals, "; ")));
  }
  return absl::FailedPreconditionError(
      absl::StrFormat("it has %d grids that can %s; name one of them: %s", fitting.size(),
                      reading.verb(), absl::StrJoin(names, ", ")));
}

absl::StatusOr<std::size_t> find_grid(VdbFile& file,
                                      const std::string& name,
                                      const Reading& reading) {
  if (file.grid_count() == 0) return absl::FailedPreconditionError("it holds no grid");
  return name.empty() ? find_only(file, reading) : find_named(file, name);
}

/// Calls `copy(grid)` of the grid that is meant, its values read.
template <class Copy, class Made = std::invoke_result_t<Copy, const openvdb::GridBase&>>
Made load_grid(const OpenGridFile& source,
               const std::string& grid_name,
               const Reading& reading,
               const LoadLimits& limits,
               const Copy& copy) {
  const auto charge = [&](const VdbOutline& o) {
    return loading_charge(o, grid_name, reading.use);
  };
  if (absl::Status s = check_bytes(source, limits, charge); !s.ok()) return s;
  return with_file(source, [&](VdbFile& file) -> Made {
    const absl::StatusOr<std::size_t> i = find_grid(file, grid_name, reading);
    if (!i.ok()) return told_of(absl::StrFormat("'%s'", source.name), i.status());
    const auto made = [&]() -> Made {
      if (absl::Status s = reading.check(file.grid(*i)); !s.ok()) return s;
      file.read_topology(*i);
      file.read_values(*i);
      return copy(file.grid(*i));
    };
    Made volume = made();
    if (volume.ok()) {
      volume->name = file.grid_name(*i);
      return volume;
    }
    return told_of(absl::StrFormat("grid '%s' of '%s'", file.grid_name(*i), source.name),
                   volume.status());
  });
}

absl::Status check_triangles(const OpenGridFile& file, const LoadLimits& limits) {
  if (limits.walked) return absl::OkStatus();
  return charge_triangles(file, limits.max_bytes, limits.max_reading_bytes).status();
}

absl::StatusOr<std::vector<GridInfo>> list_triangles(const OpenGridFile& source) {
  const absl::StatusOr<openvdb::FloatGrid::Ptr> grid = read_surface_grid(source);
  if (!grid.ok()) return grid.status();
  return std::vector<GridInfo>{describe(**grid, (*grid)->getName())};
}

/// The only grid of a file of triangles.
absl::StatusOr<Volume> load_triangles(const OpenGridFile& source,
                                      const std::string& grid_name,
                                      const Reading& reading) {
  const absl::StatusOr<openvdb::FloatGrid::Ptr> grid = read_surface_grid(source);
  if (!grid.ok()) return grid.status();
  const std::string name = (*grid)->getName();
  if (!grid_name.empty() && grid_name != name) {
    return absl::NotFoundError(
        absl::StrFormat("there is no grid '%s'; the file has '%s'", grid_name, name));
  }
  absl::StatusOr<Volume> volume = reading.copy(**grid);
  if (!volume.ok()) return told_of_triangles(source, volume.status());
  volume->name = name;
  return volume;
}

absl::StatusOr<Volume> load(const OpenGridFile& source,
                            const std::string& grid_name,
                            const Reading& reading,
                            const LoadLimits& limits) {
  if (holds_triangles(source)) {
    if (absl::Status s = check_triangles(source, limits); !s.ok()) return s;
    return load_triangles(source, grid_name, reading);
  }
  if (holds_image(source)) {
    if (absl::Status s = check_image(source, limits, false); !s.ok()) return s;
    return load_image_file(source, grid_name, reading.use, reading.component, limits);
  }
  return load_grid(source, grid_name, reading, limits,
                   [&](const openvdb::GridBase& grid) { return reading.copy(grid); });
}

}  // namespace

absl::StatusOr<std::vector<GridInfo>> list_grids(const std::string& path,
                                                 const LoadLimits& limits) {
  return with_path(path, [&](const OpenGridFile& file) { return list_grids(file, limits); });
}

absl::StatusOr<std::vector<GridInfo>> list_grids(const OpenGridFile& source,
                                                 const LoadLimits& limits) {
  if (holds_triangles(source)) {
    if (absl::Status s = check_triangles(source, limits); !s.ok()) return s;
    return list_triangles(source);
  }
  if (holds_image(source)) {
    if (absl::Status s = check_image(source, limits, true); !s.ok()) return s;
    return list_image_file(source);
  }
  if (absl::Status s = check_bytes(source, limits, listing_charge); !s.ok()) return s;
  return with_file(source, [](VdbFile& file) -> absl::StatusOr<std::vector<GridInfo>> {
    std::vector<GridInfo> grids;
    for (std::size_t i = 0; i < file.grid_count(); ++i) grids.push_back(describe(file, i));
    return grids;
  });
}

absl::StatusOr<Volume> load_volume(const std::string& path,
                                   const std::string& grid_name,
                                   const LoadLimits& limits) {
  return with_path(
      path, [&](const OpenGridFile& file) { return load_volume(file, grid_name, limits); });
}

absl::StatusOr<Volume> load_volume(const OpenGridFile& source,
                                   const std::string& grid_name,
                                   const LoadLimits& limits) {
  return load(source, grid_name, {GridUse::kSurface}, limits);
}

absl::StatusOr<Volume> load_field(const std::string& path,
                                  const std::string& grid_name,
                                  std::uint32_t component,
                                  const LoadLimits& limits) {
  return with_path(path, [&](const OpenGridFile& file) {
    return load_field(file, grid_name, component, limits);
  });
}

absl::StatusOr<Volume> load_field(const OpenGridFile& source,
                                  const std::string& grid_name,
                                  std::uint32_t component,
                                  const LoadLimits& limits) {
  return load(source, grid_name, {GridUse::kField, component}, limits);
}

absl::StatusOr<LabelVolume> load_labels(const std::string& path,
                                        const std::string& grid_name,
                                        const LoadLimits& limits) {
  return with_path(
      path, [&](const OpenGridFile& file) { return load_labels(file, grid_name, limits); });
}

absl::StatusOr<LabelVolume> load_labels(const OpenGridFile& source,
                                        const std::string& grid_name,
                                        const LoadLimits& limits) {
  if (!holds_image(source)) {
    return load_grid(source, grid_name, {GridUse::kLabels}, limits, copy_labels);
  }
  if (absl::Status s = check_image(source, limits, false); !s.ok()) return s;
  return load_label_file(source, grid_name, limits);
}

void prepare_loading() { openvdb::initialize(); }

}  // namespace tet
