#include "client/library/wire_request.h"

#include <span>

#include "core/plan/vertex_field.h"
#include "proto/sizing/sizing_message.h"

namespace tet {
namespace {

v1::Preset wire_preset(Preset preset) {
  switch (preset) {
    case Preset::kDefault:
      return v1::PRESET_DEFAULT;
    case Preset::kMinAngle:
      return v1::PRESET_MIN_ANGLE;
    case Preset::kBothSides:
      return v1::PRESET_BOTH_SIDES;
  }
  return v1::PRESET_UNSPECIFIED;
}

v1::CoordinateType wire_coordinates(std::optional<CoordinateType> type) {
  if (!type) return v1::COORDINATE_TYPE_UNSPECIFIED;
  return *type == CoordinateType::kFloat64 ? v1::COORDINATE_TYPE_FLOAT64
                                           : v1::COORDINATE_TYPE_FLOAT32;
}

void set_point(const WorldPoint& point, v1::Point& message) {
  message.set_x(point.x);
  message.set_y(point.y);
  message.set_z(point.z);
}

void add_fields(std::span<const VertexField> fields, v1::MeshRequest& message) {
  for (const VertexField& field : fields) {
    v1::Field& added = *message.add_fields();
    added.set_name(field.name);
    added.set_grid(field.file);
    added.set_grid_name(field.grid);
  }
}

}  // namespace

v1::MeshRequest wire_request(const MeshRequest& request,
                             const std::string& name,
                             const std::vector<std::string>& grids) {
  v1::MeshRequest message;
  message.set_name(name);
  if (grids.size() == 1) message.set_grid_name(grids.front());
  if (grids.size() > 1) message.mutable_grid_names()->Assign(grids.begin(), grids.end());
  if (request.spacing) message.set_spacing(*request.spacing);
  if (request.iso) message.set_iso(*request.iso);
  message.set_levels(request.levels);
  message.set_preset(wire_preset(request.preset));
  message.set_improve(request.improve);
  message.set_coordinate_type(wire_coordinates(request.coordinates));
  if (request.box) {
    set_point(request.box->min, *message.mutable_box()->mutable_min());
    set_point(request.box->max, *message.mutable_box()->mutable_max());
  }
  message.set_manifold(request.manifold);
  message.set_skip_statistics(request.skip_statistics);
  if (request.sizing.any()) *message.mutable_sizing() = message_of_sizing(request.sizing);
  add_fields(request.fields, message);
  return message;
}

}  // namespace tet
