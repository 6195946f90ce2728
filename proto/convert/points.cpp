#include "proto/convert/points.h"

#include <cmath>

namespace tet {

void to_proto(const WorldPoint& point, v1::Point& message) {
  message.set_x(point.x);
  message.set_y(point.y);
  message.set_z(point.z);
}

void to_proto(const WorldBox& box, v1::Box& message) {
  to_proto(box.min, *message.mutable_min());
  to_proto(box.max, *message.mutable_max());
}

WorldPoint from_proto(const v1::Point& message) {
  return {message.x(), message.y(), message.z()};
}

WorldBox from_proto(const v1::Box& message) {
  return {from_proto(message.min()), from_proto(message.max())};
}

bool is_finite(const v1::Point& message) {
  return std::isfinite(message.x()) && std::isfinite(message.y()) && std::isfinite(message.z());
}

bool is_finite(const v1::Box& message) {
  return is_finite(message.min()) && is_finite(message.max());
}

}  // namespace tet
