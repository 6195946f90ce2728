// Scenes that are refused, and how far those that are not reach.
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "core/scene/scene.h"
#include "tests/support/scenes.h"

namespace tet {
namespace {

using namespace scene;
using test::SceneWriter;

std::string refusal_of(const Description& description) {
  return std::string(make_scene(description).status().message());
}

template <class... Nodes>
std::string refusal_of_nodes(Nodes... nodes) {
  Description description;
  description.nodes = {nodes...};
  return refusal_of(description);
}

template <class Kind>
Node named(const std::string& name, Kind kind) {
  return Node{name, std::move(kind)};
}

template <class Kind>
std::string refusal_of(Kind kind) {
  return refusal_of_nodes(named("", std::move(kind)));
}

/// What is said of a node within so many transforms, each of the one before.
std::string refusal_within(int count, const Transform& each, scene::Node node) {
  Description description;
  node.name = "0";
  description.nodes.push_back(std::move(node));
  for (int i = 1; i <= count; ++i) {
    Transform transform = each;
    transform.of = std::to_string(i - 1);
    description.nodes.push_back(named(std::to_string(i), transform));
  }
  return refusal_of(description);
}

TEST(MakeScene, RefusesTransformsThatTogetherLeaveTheNumbers) {
  const Node sphere = named("", Sphere{1}), half_space = named("", HalfSpace{{0, 0, 1}, 2});
  const auto scaled = [](double x, double y, double z) {
    Transform transform;
    transform.scale = {x, y, z};
    return transform;
  };
  for (const double scale : {1e-15, 1e15}) {
    const Transform each = scaled(scale, scale, scale);
    EXPECT_EQ(refusal_within(3, each, sphere), "");
    EXPECT_EQ(refusal_within(3, each, half_space), "");
    for (const Node& node : {sphere, half_space}) {
      EXPECT_TRUE(refusal_within(22, each, node).find("which is not from 1e-60 to 1e+60") !=
                  std::string::npos)
          << refusal_within(22, each, node);
    }
  }
  EXPECT_EQ(refusal_within(10, scaled(1e15, 1, 1), sphere), "");
  EXPECT_EQ(refusal_within(22, scaled(1e15, 1, 1), sphere).substr(0, 40),
            "nodes[0].sphere has the determinant 0 by");
  Transform moved = scaled(1e-15, 1e-15, 1e-15);
  moved.translation = {1, 0, 0};
  EXPECT_EQ(refusal_within(3, moved, sphere), "");
  EXPECT_NE(refusal_within(22, moved, sphere), "");
}

TEST(MakeScene, NamesTheSizeThatCannotBe) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(refusal_of(Sphere{0}), "nodes[0].sphere.radius 0 is not from 1e-15 to 1e+15");
  EXPECT_EQ(refusal_of(Torus{1, -1}),
            "nodes[0].torus.minor_radius -1 is not from 1e-15 to 1e+15");
  EXPECT_EQ(refusal_of(Sphere{kNaN}), "nodes[0].sphere.radius nan is not from 1e-15 to 1e+15");
  EXPECT_EQ(refusal_of(Ellipsoid{{1, kInf, 1}}),
            "nodes[0].ellipsoid.semi_axes[1] inf is not from 1e-15 to 1e+15");
  EXPECT_EQ(refusal_of(RoundedBox{{1, 2, 3}, 0.6}),
            "nodes[0].rounded_box.rounding 0.6 is more than half the shortest edge, 0.5");
  EXPECT_EQ(refusal_of(Cone{0, 0, 1}),
            "nodes[0].cone.bottom_radius and top_radius are both 0: one may be");
  EXPECT_EQ(refusal_of(HalfSpace{}),
            "nodes[0].half_space.normal has no direction: all three numbers are 0");
  EXPECT_EQ(refusal_of(PeriodicSurface{PeriodicKind::kSchwarzP, 1, 0.0}),
            "nodes[0].schwarz_p.thickness 0 is not from 1e-15 to 1e+15");
  EXPECT_EQ(refusal_of(std::monostate{}),
            "nodes[0] is of no kind: set sphere, union or another");
  EXPECT_EQ(refusal_of({}), "nodes is empty");
}

TEST(MakeScene, FollowsNamesToEarlierNodesOnly) {
  const Node ball = named("ball", Sphere{1});
  EXPECT_EQ(refusal_of_nodes(ball, named("grown", Offset{"bal", 1})),
            "nodes[1].offset.of \"bal\" is not the name of an earlier node");
  EXPECT_EQ(refusal_of_nodes(named("a", Offset{"b", 1}), named("b", Offset{"a", 1})),
            "nodes[0].offset.of \"b\" is not the name of an earlier node");
  Combination both;
  both.of = {"ball", "self"};
  EXPECT_EQ(refusal_of_nodes(ball, named("self", both)),
            "nodes[1].union.of[1] \"self\" is not the name of an earlier node");
  EXPECT_EQ(refusal_of_nodes(ball, ball), "nodes[1].name \"ball\" is taken by nodes[0]");
  EXPECT_EQ(refusal_of_nodes(named(std::string(65, 'a'), Sphere{1})),
            "nodes[0].name has 65 bytes; the limit is 64");
  EXPECT_EQ(refusal_of_nodes(ball, named("other", Sphere{2})),
            "nodes[0].sphere is used by no later node, and only the last one may be: it is the "
            "scene");
  EXPECT_EQ(refusal_of_nodes(ball, named("", Combination{})),
            "nodes[1].union.of names no nodes");
}

TEST(MakeScene, BoundsNodesDepthAndCopies) {
  SceneWriter deep;
  std::string node = deep.add(Sphere{1});
  for (int i = 0; i < Scene::kMaxDepth; ++i) node = deep.add(Offset{node, 0.01});
  EXPECT_EQ(refusal_of(deep.description()),
            "nodes[64].offset is 65 nodes deep; the limit is 64");

  SceneWriter doubling;
  node = doubling.add(Sphere{1});
  for (int i = 0; i < 60; ++i) node = doubling.add(Combination{Combine::kUnion, {node, node}});
  EXPECT_EQ(
      refusal_of(doubling.description()),
      "nodes[12].union is 8191 primitives and operators, every copy counted; the limit is "
      "4096");

  SceneWriter rows;
  Repeat repeat{rows.add(Sphere{1}), {2000000000, 2000000000, 2000000000}, {3, 3, 3}};
  rows.add(repeat);
  EXPECT_EQ(
      refusal_of(rows.description()),
      "nodes[1].repeat is 1.6e+28 primitives and operators, every copy counted; the limit "
      "is 4096");

  Description many;
  many.nodes.resize(1025);
  EXPECT_EQ(refusal_of(many), "nodes has 1025 entries; the limit is 1024");
}

TEST(MakeScene, SaysWhichNodeHasNoEnd) {
  SceneWriter writer;
  const std::string gyroid = writer.add(PeriodicSurface{PeriodicKind::kGyroid, 1, 0.2});
  const std::string ball = writer.add(Sphere{1});
  SceneWriter ended = writer;
  writer.add(Combination{Combine::kUnion, {gyroid, ball}});
  EXPECT_EQ(
      check_ends(writer.scene()).message(),
      "nodes[0].gyroid has no end, and nothing ends the scene: take its intersection with "
      "something that ends, or mesh both sides within a box");
  ended.add(Combination{Combine::kIntersection, {gyroid, ball}});
  EXPECT_TRUE(check_ends(ended.scene()).ok());
}

TEST(MakeScene, KnowsThatSixHalfSpacesHaveAnEnd) {
  SceneWriter writer;
  Combination sides{Combine::kIntersection, {}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const double sign : {-2.0, 2.0}) {
      HalfSpace side{{}, 1.5};
      side.normal[axis] = sign;
      sides.of.push_back(writer.add(side));
    }
  }
  writer.add(sides);
  const Scene scene = writer.scene();
  EXPECT_TRUE(scene.ends());
  EXPECT_DOUBLE_EQ(scene.extent.min.y, -1.5);
  EXPECT_DOUBLE_EQ(scene.extent.max.z, 1.5);
}

TEST(MakeScene, KnowsThatBallsApartHaveNothingInCommon) {
  SceneWriter writer;
  const std::string ball = writer.add(Sphere{1});
  const std::string other = writer.add_moved({3, 0, 0}, ball);
  writer.add(Combination{Combine::kIntersection, {ball, other}});
  EXPECT_GT(writer.scene().extent.min.x, writer.scene().extent.max.x);
}

}  // namespace
}  // namespace tet
