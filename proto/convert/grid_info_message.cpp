#include "proto/convert/grid_info_message.h"

#include <absl/status/status.h>
#include <absl/strings/str_cat.h>

#include "core/base/printable.h"
#include "core/volume/inside.h"

namespace tet {
namespace {

void to_proto(const VoxelBox& box, v1::VoxelBox& message) {
  message.set_min_x(box.min.x);
  message.set_min_y(box.min.y);
  message.set_min_z(box.min.z);
  message.set_max_x(box.max.x);
  message.set_max_y(box.max.y);
  message.set_max_z(box.max.z);
}

VoxelBox box_of(const v1::VoxelBox& message) {
  return {{message.min_x(), message.min_y(), message.min_z()},
          {message.max_x(), message.max_y(), message.max_z()}};
}

v1::InsideSource source_message(KindSource source) {
  switch (source) {
    case KindSource::kMaker:
    case KindSource::kClass:
      return v1::INSIDE_SOURCE_CLASS;
    case KindSource::kValues:
      return v1::INSIDE_SOURCE_VALUES;
    case KindSource::kNobody:
      return v1::INSIDE_SOURCE_NOBODY;
  }
  return v1::INSIDE_SOURCE_UNSPECIFIED;
}

absl::StatusOr<KindSource> source_of(v1::InsideSource source) {
  switch (source) {
    case v1::INSIDE_SOURCE_CLASS:
      return KindSource::kClass;
    case v1::INSIDE_SOURCE_VALUES:
      return KindSource::kValues;
    case v1::INSIDE_SOURCE_NOBODY:
      return KindSource::kNobody;
    default:
      return absl::InvalidArgumentError(
          absl::StrCat("inside_source ", static_cast<int>(source), " means nothing here"));
  }
}

absl::StatusOr<GridValues> values_of(const v1::GridValues& message) {
  const auto source = source_of(message.inside_source());
  if (!source.ok()) return source.status();
  const auto side = parse_side(message.inside());
  if (!side) {
    return absl::InvalidArgumentError(
        absl::StrCat("inside \"", printable(message.inside(), 20), "\" is no side"));
  }
  return GridValues{{message.min(), message.max()}, message.background(), *side, *source};
}

}  // namespace

void to_proto(const GridInfo& info, v1::GridInfo& message) {
  message.set_name(info.name);
  message.set_value_type(info.value_type);
  message.set_grid_class(info.grid_class);
  message.set_voxel_size(info.voxel_size);
  message.set_active_voxel_count(info.active_voxels);
  message.set_background(info.background);
  message.set_not_meshable_reason(info.not_meshable);
  message.set_field_components(static_cast<std::int32_t>(info.field_components));
  message.set_made_of(info.made_of);
  message.set_place(info.place);
  if (!info.active_box.empty()) to_proto(info.active_box, *message.mutable_active_box());
}

void to_proto(const GridContents& contents, v1::GridInfo& message) {
  if (!contents.not_meshable.empty()) message.set_not_meshable_reason(contents.not_meshable);
  if (contents.values) {
    v1::GridValues& values = *message.mutable_values();
    values.set_min(contents.values->range.min);
    values.set_max(contents.values->range.max);
    values.set_background(contents.values->background);
    values.set_inside(side_name(contents.values->inside));
    values.set_inside_source(source_message(contents.values->source));
  }
  message.set_label_count(static_cast<std::int64_t>(contents.label_count));
  for (const LabelExtent& label : contents.labels) {
    v1::GridLabel& added = *message.add_labels();
    added.set_value(label.value);
    added.set_voxel_count(label.voxels);
    to_proto(label.box, *added.mutable_box());
  }
}

GridInfo grid_info_of(const v1::GridInfo& message) {
  GridInfo info;
  info.name = message.name();
  info.value_type = message.value_type();
  info.grid_class = message.grid_class();
  info.voxel_size = message.voxel_size();
  info.active_voxels = message.active_voxel_count();
  if (message.has_active_box()) info.active_box = box_of(message.active_box());
  info.background = message.background();
  info.not_meshable = message.not_meshable_reason();
  info.field_components = static_cast<std::uint32_t>(message.field_components());
  info.made_of = message.made_of();
  info.place = message.place();
  return info;
}

absl::StatusOr<GridContents> contents_of(const v1::GridInfo& message) {
  GridContents contents;
  if (message.has_values()) {
    const auto values = values_of(message.values());
    if (!values.ok()) return values.status();
    contents.values = *values;
  }
  contents.label_count = static_cast<std::uint64_t>(message.label_count());
  for (const v1::GridLabel& label : message.labels()) {
    contents.labels.push_back({label.value(), label.voxel_count(), box_of(label.box())});
  }
  return contents;
}

}  // namespace tet
