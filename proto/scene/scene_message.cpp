#include "proto/scene/scene_message.h"

#include <cstdint>
#include <utility>
#include <variant>

#include <absl/strings/str_cat.h>

#include "core/volume/inside.h"
#include "proto/scene/message_parts.h"

namespace tet {
namespace {

namespace v1 = ::tetstream::v1;

/// Reads the fields of one node; the first list of the wrong length stays as the complaint.
class NodeReader {
 public:
  explicit NodeReader(const v1::SceneNode& node) : node_(node) {}

  decltype(scene::Node::kind) kind();
  /// `torus.semi_axes has 2 numbers, not 3`; empty if nothing was wrong.
  const std::string& complaint() const { return complaint_; }

 private:
  template <class Field, class Numbers>
  void read(const char* field, const Field& given, Numbers& numbers) {
    std::string wrong = read_three(field, given, numbers);
    if (!wrong.empty()) complaint_ = std::move(wrong);
  }

  scene::PeriodicSurface periodic(scene::PeriodicKind kind, const v1::PeriodicSurface& given) {
    scene::PeriodicSurface surface{kind, given.period(), {}};
    if (given.has_thickness()) surface.thickness = given.thickness();
    return surface;
  }
  scene::Combination combination(scene::Combine how, const v1::Combination& given) {
    return {how, {given.of().begin(), given.of().end()}, given.smoothing()};
  }
  scene::Ellipsoid ellipsoid(const v1::Ellipsoid& given) {
    scene::Ellipsoid ellipsoid;
    read("ellipsoid.semi_axes", given.semi_axes(), ellipsoid.semi_axes);
    return ellipsoid;
  }
  scene::RoundedBox rounded_box(const v1::RoundedBox& given) {
    scene::RoundedBox box{{}, given.rounding()};
    read("rounded_box.size", given.size(), box.size);
    return box;
  }
  scene::HalfSpace half_space(const v1::HalfSpace& given) {
    scene::HalfSpace half_space{{}, given.offset()};
    read("half_space.normal", given.normal(), half_space.normal);
    return half_space;
  }
  scene::Transform transform(const v1::Transform& given) {
    scene::Transform transform;
    transform.of = given.of();
    read("transform.scale", given.scale(), transform.scale);
    read("transform.axis", given.axis(), transform.axis);
    transform.angle_deg = given.angle_deg();
    read("transform.translation", given.translation(), transform.translation);
    return transform;
  }
  scene::Repeat repeat(const v1::Repeat& given) {
    scene::Repeat repeat;
    repeat.of = given.of();
    read("repeat.count", given.count(), repeat.count);
    read("repeat.step", given.step(), repeat.step);
    return repeat;
  }

  scene::GridSolid grid(const v1::GridSolid& given) {
    scene::GridSolid grid{given.name(), given.grid_name(), {}, nullptr, {}};
    if (given.has_iso()) grid.iso = given.iso();
    grid.inside = parse_side(given.inside());
    if (!given.inside().empty() && !grid.inside && complaint_.empty()) {
      complaint_ = absl::StrCat("grid.inside \"", given.inside().substr(0, 20),
                                "\" is neither \"below\" nor \"above\"");
    }
    return grid;
  }

  const v1::SceneNode& node_;
  std::string complaint_;
};

decltype(scene::Node::kind) NodeReader::kind() {
  using scene::Combine;
  using scene::PeriodicKind;
  switch (node_.kind_case()) {
    case v1::SceneNode::kSphere:
      return scene::Sphere{node_.sphere().radius()};
    case v1::SceneNode::kEllipsoid:
      return ellipsoid(node_.ellipsoid());
    case v1::SceneNode::kRoundedBox:
      return rounded_box(node_.rounded_box());
    case v1::SceneNode::kCylinder:
      return scene::Cylinder{node_.cylinder().radius(), node_.cylinder().height()};
    case v1::SceneNode::kCone:
      return scene::Cone{node_.cone().bottom_radius(), node_.cone().top_radius(),
                         node_.cone().height()};
    case v1::SceneNode::kTorus:
      return scene::Torus{node_.torus().major_radius(), node_.torus().minor_radius()};
    case v1::SceneNode::kCapsule:
      return scene::Capsule{node_.capsule().radius(), node_.capsule().length()};
    case v1::SceneNode::kHalfSpace:
      return half_space(node_.half_space());
    case v1::SceneNode::kGyroid:
      return periodic(PeriodicKind::kGyroid, node_.gyroid());
    case v1::SceneNode::kSchwarzP:
      return periodic(PeriodicKind::kSchwarzP, node_.schwarz_p());
    case v1::SceneNode::kDiamond:
      return periodic(PeriodicKind::kDiamond, node_.diamond());
    case v1::SceneNode::kUnion:
      return combination(Combine::kUnion, node_.union_());
    case v1::SceneNode::kIntersection:
      return combination(Combine::kIntersection, node_.intersection());
    case v1::SceneNode::kDifference:
      return combination(Combine::kDifference, node_.difference());
    case v1::SceneNode::kOffset:
      return scene::Offset{node_.offset().of(), node_.offset().distance()};
    case v1::SceneNode::kShell:
      return scene::Shell{node_.shell().of(), node_.shell().thickness()};
    case v1::SceneNode::kTransform:
      return transform(node_.transform());
    case v1::SceneNode::kRepeat:
      return repeat(node_.repeat());
    case v1::SceneNode::kGrid:
      return grid(node_.grid());
    default:
      return std::monostate{};
  }
}

absl::StatusOr<scene::Description> to_description(const v1::Scene& message) {
  scene::Description description;
  for (int i = 0; i < message.nodes_size(); ++i) {
    NodeReader reader(message.nodes(i));
    description.nodes.push_back({message.nodes(i).name(), reader.kind()});
    if (reader.complaint().empty()) continue;
    return absl::InvalidArgumentError(absl::StrCat("nodes[", i, "].", reader.complaint()));
  }
  return description;
}

}  // namespace

absl::StatusOr<scene::Description> description_of_message(const v1::Scene& message) {
  absl::StatusOr<scene::Description> description = to_description(message);
  if (!description.ok()) return description;
  if (auto status = check_scene(*description); !status.ok()) return status;
  return description;
}

absl::StatusOr<v1::Scene> scene_from_json(const std::string& json) {
  return message_from_json<v1::Scene>(json, "scene");
}

}  // namespace tet
