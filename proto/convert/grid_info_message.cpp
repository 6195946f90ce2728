#include "proto/convert/grid_info_message.h"

namespace tet {

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
  if (info.active_box.empty()) return;
  v1::VoxelBox& box = *message.mutable_active_box();
  box.set_min_x(info.active_box.min.x);
  box.set_min_y(info.active_box.min.y);
  box.set_min_z(info.active_box.min.z);
  box.set_max_x(info.active_box.max.x);
  box.set_max_y(info.active_box.max.y);
  box.set_max_z(info.active_box.max.z);
}

}  // namespace tet
