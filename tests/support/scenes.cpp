#include "tests/support/scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <numbers>
#include <random>
#include <utility>

namespace tet::test {
namespace {

using namespace scene;

constexpr double kPi = std::numbers::pi;

template <class Kind>
Scene alone(Kind kind) {
  SceneWriter writer;
  writer.add(std::move(kind));
  return writer.scene();
}

/// Two balls of radius 1, `apart`, put together.
Scene two_balls(Combine how, double apart, double smoothing) {
  SceneWriter writer;
  const std::string ball = writer.add(Sphere{1});
  const std::string other = writer.add_moved({apart, 0, 0}, ball);
  writer.add(Combination{how, {ball, other}, smoothing});
  return writer.scene();
}

Scene ball_with_cavity() {
  SceneWriter writer;
  const std::string ball = writer.add(Sphere{1});
  const std::string cavity = writer.add(Sphere{0.5});
  writer.add(Combination{Combine::kDifference, {ball, cavity}, 0});
  return writer.scene();
}

/// A box with a round hole along each axis: genus 5, five holes through a cube's frame.
Scene drilled_box() {
  SceneWriter writer;
  const std::string box = writer.add(RoundedBox{{2, 2, 2}, 0.2});
  const std::string along_z = writer.add(Cylinder{0.5, 3});
  Transform turn;
  turn.of = along_z;
  turn.angle_deg = 90;
  turn.axis = {0, 1, 0};
  const std::string along_x = writer.add(turn);
  turn.axis = {1, 0, 0};
  const std::string along_y = writer.add(turn);
  writer.add(Combination{Combine::kDifference, {box, along_x, along_y, along_z}, 0.1});
  return writer.scene();
}

Scene grid_of_balls() {
  SceneWriter writer;
  const std::string ball = writer.add(Sphere{0.4});
  Repeat repeat;
  repeat.of = ball;
  repeat.count = {3, 2, 2};
  repeat.step = {1, 1.1, 1.2};
  writer.add(repeat);
  return writer.scene();
}

Scene hollow_torus() {
  SceneWriter writer;
  const std::string torus = writer.add(Torus{1, 0.5});
  writer.add(Shell{torus, 0.3});
  return writer.scene();
}

Scene grown_tilted_box() {
  SceneWriter writer;
  const std::string box = writer.add(RoundedBox{{1, 0.8, 0.6}, 0});
  Transform tilt;
  tilt.of = box;
  tilt.axis = {1, 2, 3};
  tilt.angle_deg = 40;
  tilt.translation = {10, -20, 30};
  const std::string tilted = writer.add(tilt);
  writer.add(Offset{tilted, 0.2});
  return writer.scene();
}

Scene half_ball() {
  SceneWriter writer;
  const std::string ball = writer.add(Sphere{1});
  const std::string below = writer.add(HalfSpace{{0.36, 0.48, 0.8}, 0});
  writer.add(Combination{Combine::kIntersection, {ball, below}, 0});
  return writer.scene();
}

/// Volume of a box grown by `r`.
double grown_box_volume(double x, double y, double z, double r) {
  return x * y * z + 2 * r * (x * y + y * z + z * x) + kPi * r * r * (x + y + z) +
         4.0 / 3 * kPi * r * r * r;
}

/// Random numbers with the same bits everywhere, unlike the standard's distributions.
class Dice {
 public:
  explicit Dice(std::uint32_t seed) : engine_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_()) / 4294967296.0);
  }
  std::uint32_t below(std::uint32_t count) {
    return static_cast<std::uint32_t>(engine_()) % count;
  }
  Triple triple(double low, double high) {
    const double x = between(low, high), y = between(low, high), z = between(low, high);
    return {x, y, z};
  }

 private:
  std::mt19937 engine_;
};

std::string random_primitive(SceneWriter& writer, Dice& dice) {
  const auto size = [&] { return dice.between(0.3, 0.9); };
  switch (dice.below(9)) {
    case 0:
      return writer.add(Sphere{size()});
    case 1:
      return writer.add(Ellipsoid{dice.triple(0.3, 0.9)});
    case 2:
      return writer.add(RoundedBox{dice.triple(0.6, 1.5), dice.between(0, 0.3)});
    case 3:
      return writer.add(Cylinder{size(), size()});
    case 4:
      return writer.add(Cone{size(), dice.between(0, 0.5), size()});
    case 5:
      return writer.add(Torus{size(), dice.between(0.15, 0.3)});
    case 6:
      return writer.add(Capsule{dice.between(0.2, 0.5), size()});
    case 7:
      return writer.add(HalfSpace{dice.triple(-1, 1), dice.between(-0.5, 0.5)});
    default:
      return writer.add(PeriodicSurface{static_cast<PeriodicKind>(dice.below(3)),
                                        dice.between(1, 2), dice.between(0.2, 0.4)});
  }
}

std::string placed(SceneWriter& writer, Dice& dice, std::string of) {
  Transform transform;
  transform.of = std::move(of);
  transform.axis = dice.triple(0.1, 1);
  transform.angle_deg = dice.between(-180, 180);
  transform.translation = dice.triple(-0.8, 0.8);
  if (dice.below(2) == 0) transform.scale = dice.triple(0.6, 1.4);
  return writer.add(transform);
}

std::string random_part(SceneWriter& writer, Dice& dice, int depth) {
  if (depth == 0) return placed(writer, dice, random_primitive(writer, dice));
  switch (dice.below(6)) {
    case 0:
      return writer.add(Offset{random_part(writer, dice, depth - 1), dice.between(-0.1, 0.1)});
    case 1:
      return writer.add(Shell{random_part(writer, dice, depth - 1), dice.between(0.2, 0.4)});
    default: {
      Combination combination{static_cast<Combine>(dice.below(3)), {}, 0};
      for (std::uint32_t parts = 2 + dice.below(2); parts > 0; --parts) {
        combination.of.push_back(random_part(writer, dice, depth - 1));
      }
      if (dice.below(2) == 0) combination.smoothing = dice.between(0.01, 0.4);
      return writer.add(combination);
    }
  }
}

}  // namespace

Scene SceneWriter::scene() const {
  absl::StatusOr<Scene> made = make_scene(description_);
  if (made.ok()) return *std::move(made);
  std::cerr << made.status() << '\n';
  std::abort();
}

std::vector<KnownScene> known_scenes() {
  const double ball = 4.0 / 3 * kPi;
  std::vector<KnownScene> scenes;
  const auto add = [&](std::string name, Scene scene, double spacing, std::uint64_t components,
                       std::int64_t euler, double volume) {
    scenes.push_back({std::move(name), std::move(scene), spacing, components, euler, volume});
  };
  add("sphere", alone(Sphere{1}), 0.1, 1, 2, ball);
  add("ellipsoid", alone(Ellipsoid{{1, 0.7, 0.5}}), 0.07, 1, 2, ball * 0.35);
  add("box", alone(RoundedBox{{1, 2, 1.5}, 0}), 0.09, 1, 2, 3);
  add("rounded box", alone(RoundedBox{{2, 1.6, 1.2}, 0.3}), 0.1, 1, 2,
      grown_box_volume(1.4, 1, 0.6, 0.3));
  add("cylinder", alone(Cylinder{0.8, 1.5}), 0.09, 1, 2, kPi * 0.64 * 1.5);
  add("cone", alone(Cone{1, 0.4, 1.5}), 0.09, 1, 2, kPi / 3 * 1.5 * 1.56);
  add("pointed cone", alone(Cone{1, 0, 1.5}), 0.09, 1, 2, kPi / 2);
  add("torus", alone(Torus{1, 0.4}), 0.09, 1, 0, 2 * kPi * kPi * 0.16);
  add("capsule", alone(Capsule{0.5, 1}), 0.09, 1, 2, kPi * 0.25 + ball / 8);
  add("union", two_balls(Combine::kUnion, 1.2, 0), 0.1, 1, 2, 0);
  add("blend", two_balls(Combine::kUnion, 2.1, 0.5), 0.1, 1, 2, 0);
  add("lens", two_balls(Combine::kIntersection, 1, 0), 0.07, 1, 2, 5 * kPi / 12);
  add("moon", two_balls(Combine::kDifference, 1, 0), 0.07, 1, 2, ball - 5 * kPi / 12);
  add("two balls apart", two_balls(Combine::kUnion, 2.6, 0), 0.1, 2, 4, 2 * ball);
  add("ball with a cavity", ball_with_cavity(), 0.08, 2, 4, ball * 0.875);
  add("half ball", half_ball(), 0.09, 1, 2, ball / 2);
  add("drilled box", drilled_box(), 0.08, 1, -8, 0);
  add("balls in rows", grid_of_balls(), 0.09, 12, 24, 12 * ball * 0.064);
  add("hollow torus", hollow_torus(), 0.08, 2, 0, 2 * kPi * kPi * (0.65 * 0.65 - 0.35 * 0.35));
  add("grown tilted box", grown_tilted_box(), 0.06, 1, 2, grown_box_volume(1, 0.8, 0.6, 0.2));
  return scenes;
}

scene::Description random_scene(std::uint32_t seed) {
  Dice dice(seed);
  SceneWriter writer;
  const std::string solid = random_part(writer, dice, 1 + static_cast<int>(dice.below(3)));
  const std::string end = writer.add(Sphere{2});
  writer.add(Combination{Combine::kIntersection, {solid, end}, 0});
  return writer.description();
}

}  // namespace tet::test
