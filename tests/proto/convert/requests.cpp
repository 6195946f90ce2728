#include "tests/proto/convert/requests.h"

#include <initializer_list>
#include <string>

#include "proto/wire/sha256.h"

namespace tet {
namespace {

void set_point(double x, double y, double z, v1::Point& point) {
  point.set_x(x);
  point.set_y(y);
  point.set_z(z);
}

}  // namespace

v1::MeshRequest valid_request() {
  v1::MeshRequest request;
  request.set_name(name_of_grid(std::string(64, 'a')));
  return request;
}

v1::MeshRequest boxed_request() {
  v1::MeshRequest request = valid_request();
  request.set_preset(v1::PRESET_BOTH_SIDES);
  set_point(0, 0, 0, *request.mutable_box()->mutable_min());
  set_point(1, 1, 1, *request.mutable_box()->mutable_max());
  return request;
}

v1::MeshRequest request_with_regions() {
  v1::MeshRequest request = valid_request();
  v1::FaceRegion& region = *request.add_face_regions();
  region.set_name("bore");
  const auto set = [](auto& list, std::initializer_list<double> numbers) {
    list.Add(numbers.begin(), numbers.end());
  };
  set(*region.mutable_box()->mutable_min(), {0, 0, 0});
  set(*region.mutable_box()->mutable_max(), {1, 2, 3});
  set(*region.mutable_ball()->mutable_centre(), {1, 1, 1});
  region.mutable_ball()->set_radius(2);
  set(*region.mutable_cylinder()->mutable_end(), {0, 0, 4});
  region.mutable_cylinder()->set_radius(0.5);
  set(*region.mutable_half_space()->mutable_normal(), {0, 3, 0});
  region.mutable_half_space()->set_offset(-1);
  set(*region.mutable_nearest()->mutable_points(), {1, 2, 3, 4, 5, 6});
  set(*region.mutable_facing()->mutable_direction(), {0, 0, 1});
  region.mutable_facing()->set_angle_deg(20);
  region.set_node("bore");
  region.mutable_creases()->set_angle_deg(35);
  return request;
}

v1::MeshRequest scene_request() {
  v1::MeshRequest request;
  v1::SceneNode& node = *request.mutable_scene()->add_nodes();
  node.mutable_sphere()->set_radius(2);
  return request;
}

v1::MeshRequest sized_request() {
  v1::MeshRequest request = scene_request();
  v1::SizingRegion& region = *request.mutable_sizing()->add_regions();
  region.set_size(0.5);
  region.mutable_ball()->set_radius(1);
  return request;
}

}  // namespace tet
