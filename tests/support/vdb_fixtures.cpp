#include "tests/support/vdb_fixtures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <stdexcept>
#include <utility>

#include <openvdb/points/PointConversion.h>
#include <openvdb/tools/Prune.h>

#include "core/vdb/openvdb/vdb_grids.h"

namespace tet::test {
namespace {

using openvdb::Coord;
using openvdb::FloatGrid;
using openvdb::GridBase;
using openvdb::Vec3d;
using Solid = std::function<double(const Vec3d&)>;  // negative inside, about a distance

constexpr double kExtent = 1.6;  // every solid lies within this of the origin, on each axis

double sphere(const Vec3d& p, const Vec3d& centre, double radius) {
  return (p - centre).length() - radius;
}

double torus(const Vec3d& p) { return std::hypot(std::hypot(p.x(), p.y()) - 1, p.z()) - 0.4; }

double gyroid(const Vec3d& p) {
  constexpr double kWaves = 4;  // per 2 pi world units
  const Vec3d q = p * kWaves;
  const double wave = std::sin(q.x()) * std::cos(q.y()) + std::sin(q.y()) * std::cos(q.z()) +
                      std::sin(q.z()) * std::cos(q.x());
  const double sheet = (std::abs(wave) - 0.6) / (kWaves * std::sqrt(3.0));
  return std::max(sheet, p.length() - 1.2);
}

double two_spheres(const Vec3d& p) {
  return std::min(sphere(p, {-0.7, 0, 0}, 0.5), sphere(p, {0.7, 0, 0}, 0.5));
}

double cavity(const Vec3d& p) { return std::max(p.length() - 1, 0.5 - p.length()); }

/// Calls `visit(voxel, world position)` for every voxel within kExtent of the origin.
template <class Visit>
void for_each_voxel(double voxel, const Visit& visit) {
  const int n = static_cast<int>(std::ceil(kExtent / voxel)) + 4;
  Coord c;
  for (c.x() = -n; c.x() <= n; ++c.x()) {
    for (c.y() = -n; c.y() <= n; ++c.y()) {
      for (c.z() = -n; c.z() <= n; ++c.z()) visit(c, c.asVec3d() * voxel);
    }
  }
}

GridBase::Ptr level_set(const Solid& solid, double voxel) {
  const auto background = static_cast<float>(3 * voxel);
  FloatGrid::Ptr grid = FloatGrid::create(background);
  FloatGrid::Accessor values = grid->getAccessor();
  for_each_voxel(voxel, [&](const Coord& c, const Vec3d& p) {
    const auto phi = static_cast<float>(solid(p));
    if (phi <= -background) {
      values.setValueOff(c, -background);
    } else if (phi < background) {
      values.setValue(c, phi);
    }
  });
  openvdb::tools::pruneLevelSet(grid->tree());
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  return grid;
}

GridBase::Ptr fog(double voxel) {
  FloatGrid::Ptr grid = FloatGrid::create(0);
  FloatGrid::Accessor values = grid->getAccessor();
  for_each_voxel(voxel, [&](const Coord& c, const Vec3d& p) {
    const double density = std::clamp(0.5 - (p.length() - 1) / (4 * voxel), 0.0, 1.0);
    if (density > 0) values.setValue(c, static_cast<float>(density));
  });
  openvdb::tools::prune(grid->tree());
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  return grid;
}

GridBase::Ptr random_signs(double voxel) {
  constexpr int kEdge = 40;
  FloatGrid::Ptr grid = FloatGrid::create(static_cast<float>(3 * voxel));
  FloatGrid::Accessor values = grid->getAccessor();
  std::mt19937 random(20071);  // NOLINT(cert-msc51-cpp): the same file every time
  const auto next = [&] { return static_cast<double>(random()) / 4294967296.0 * 2 - 1; };
  Coord c;
  for (c.x() = 0; c.x() < kEdge; ++c.x()) {
    for (c.y() = 0; c.y() < kEdge; ++c.y()) {
      for (c.z() = 0; c.z() < kEdge; ++c.z()) {
        values.setValue(c.offsetBy(-kEdge / 2), static_cast<float>(next() * voxel));
      }
    }
  }
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  return grid;
}

/// A ball of 1000 in air of -1000, as a scanner in Hounsfield units has it: no class says what
/// is inside.
GridBase::Ptr scan(double voxel) {
  constexpr float kAir = -1000;
  FloatGrid::Ptr grid = FloatGrid::create(kAir);
  FloatGrid::Accessor values = grid->getAccessor();
  for_each_voxel(voxel, [&](const Coord& c, const Vec3d& p) {
    const double within = std::clamp(0.5 - (p.length() - 1) / (2 * voxel), 0.0, 1.0);
    if (within > 0) values.setValue(c, kAir + 2000 * static_cast<float>(within));
  });
  return grid;
}

/// A density without class, with a voxel just below 0.
GridBase::Ptr raw_density(double voxel) {
  const auto grid = openvdb::gridPtrCast<FloatGrid>(fog(voxel));
  grid->setGridClass(openvdb::GRID_UNKNOWN);
  grid->tree().setValue({0, 0, static_cast<int>(1.5 / voxel)}, -1e-6F);
  return grid;
}

/// Positive inside, and negative outside.
GridBase::Ptr inverted(double voxel) {
  const auto grid = openvdb::gridPtrCast<FloatGrid>(level_set(
      [](const Vec3d& p) {
        return sphere(p, {0, 0, 0}, 1);
      },
      voxel));
  const auto turned = FloatGrid::create(-grid->background());
  turned->topologyUnion(*grid);
  for (auto value = turned->beginValueAll(); value; ++value) {
    value.setValue(-grid->tree().getValue(value.getCoord()));
  }
  turned->setGridClass(openvdb::GRID_LEVEL_SET);
  return turned;
}

GridBase::Ptr vec3() {
  openvdb::Vec3SGrid::Ptr grid = openvdb::Vec3SGrid::create();
  grid->tree().setValue({1, 2, 3}, {1, 2, 3});
  return grid;
}

GridBase::Ptr points(double voxel) {
  const std::vector<openvdb::Vec3s> positions{{0, 0, 0}, {0, 1, 0}, {1, 0, 1}};
  const auto transform = openvdb::math::Transform::createLinearTransform(voxel);
  return openvdb::points::createPointDataGrid<openvdb::points::NullCodec,
                                              openvdb::points::PointDataGrid>(positions,
                                                                              *transform);
}

openvdb::math::Transform::Ptr sheared(double voxel) {
  openvdb::Mat4d matrix = openvdb::Mat4d::identity();
  matrix.preScale(Vec3d(voxel));
  matrix(1, 0) = voxel / 2;
  return openvdb::math::Transform::createLinearTransform(matrix);
}

/// `value` of the world's points at all voxels within kExtent of the origin.
template <class GridT, class Value>
typename GridT::Ptr sampled(const std::string& name,
                            double voxel,
                            const Vec3d& origin,
                            const typename GridT::ValueType& background,
                            const Value& value) {
  const typename GridT::Ptr grid = GridT::create(background);
  grid->setName(name);
  const auto transform = openvdb::math::Transform::createLinearTransform(voxel);
  transform->postTranslate(origin);
  grid->setTransform(transform);
  auto values = grid->getAccessor();
  for_each_voxel(voxel, [&](const Coord& c, const Vec3d&) {
    values.setValue(c, value(grid->indexToWorld(c)));
  });
  return grid;
}

GridBase::Ptr heat(double voxel) {
  return sampled<FloatGrid>(
      "heat", voxel, Vec3d(0.5, 0.25, -0.125) * voxel, -7,
      [](const Vec3d& p) { return static_cast<float>(1 + 2 * p.x() - 3 * p.y() + p.z() / 2); });
}

GridBase::Ptr velocity(double voxel) {
  return sampled<openvdb::Vec3SGrid>(
      "velocity", voxel, {0, 0, 0}, {0, 0, -1}, [](const Vec3d& p) {
        return openvdb::Vec3s(Vec3d(p.x() - p.y(), 2 * p.z(), 1 + p.x() / 4));
      });
}

GridBase::Ptr named_sphere(double voxel) {
  const GridBase::Ptr ball = level_set([](const Vec3d& p) { return p.length() - 1; }, voxel);
  ball->setName("sphere");
  ball->setTransform(openvdb::math::Transform::createLinearTransform(voxel));
  return ball;
}

void write_fields(double voxel, const std::string& path) {
  const GridBase::Ptr ball = named_sphere(voxel);
  const GridBase::Ptr count = sampled<openvdb::Int32Grid>("count", 4 * voxel, {0, 0, 0}, 0,
                                                          [](const Vec3d&) { return 1; });
  openvdb::io::File(path).write(
      openvdb::GridCPtrVec{ball, heat(1.5 * voxel), velocity(2 * voxel), count});
}

void write_flow(double voxel, const std::string& path) {
  openvdb::io::File(path).write(openvdb::GridCPtrVec{named_sphere(voxel), velocity(2 * voxel)});
}

/// Voxels of `voxel`, turned about the z axis by 37 degrees and moved.
openvdb::math::Transform::Ptr turned(double voxel, const Vec3d& origin) {
  openvdb::Mat4d matrix = openvdb::Mat4d::identity();
  matrix.setToRotation(Vec3d(0, 0, 1), std::atan2(3, 4));
  matrix.preScale(Vec3d(voxel));
  const auto transform = openvdb::math::Transform::createLinearTransform(matrix);
  transform->postTranslate(origin);
  return transform;
}

void write_parts(double voxel, const std::string& path) {
  const auto named = [](const char* name, const GridBase::Ptr& grid,
                        const openvdb::math::Transform::Ptr& transform) {
    grid->setName(name);
    grid->setTransform(transform);
    return grid;
  };
  const auto straight = [](double edge, const Vec3d& origin) {
    const auto transform = openvdb::math::Transform::createLinearTransform(edge);
    transform->postTranslate(origin);
    return transform;
  };
  const double wide = 1.5 * voxel;
  openvdb::io::File(path).write(openvdb::GridCPtrVec{
      named("ball", level_set([](const Vec3d& p) { return p.length() - 1; }, voxel),
            straight(voxel, {0, 0, 0})),
      velocity(2 * voxel), named("ring", level_set(torus, wide), turned(wide, {3, 0.1, 0})),
      named("cloud", fog(voxel), straight(voxel, Vec3d(0.3, 3.1, 0.7) * 1.01)),
      named("twin", level_set(two_spheres, voxel), straight(voxel, {0, 0, 0}))});
}

using Maker = std::function<GridBase::Ptr(double voxel)>;

Maker level_set_of(const Solid& solid) {
  return [solid](double voxel) { return level_set(solid, voxel); };
}

const std::vector<std::pair<std::string_view, Maker>>& makers() {
  static const auto* const all = new std::vector<std::pair<std::string_view, Maker>>{
      {"sphere", level_set_of([](const Vec3d& p) {
         return sphere(p, {0, 0, 0}, 1);
       })},
      {"torus", level_set_of(torus)},
      {"gyroid", level_set_of(gyroid)},
      {"two-spheres", level_set_of(two_spheres)},
      {"cavity", level_set_of(cavity)},
      {"random-signs", random_signs},
      {"fog", fog},
      {"scan", scan},
      {"raw-density", raw_density},
      {"inverted", inverted},
      {"empty", [](double) { return FloatGrid::create(1); }},
      {"vec3", [](double) { return vec3(); }},
      {"points", points},
      {"sheared", level_set_of([](const Vec3d& p) {
         return sphere(p, {0, 0, 0}, 1);
       })},
  };
  return *all;
}

}  // namespace

std::vector<std::string_view> fixture_kinds() {
  std::vector<std::string_view> kinds;
  for (const auto& [kind, make] : makers()) kinds.push_back(kind);
  return kinds;
}

void write_fixture(std::string_view kind, double voxel, const std::string& path) {
  openvdb::initialize();
  if (kind == "fields") return write_fields(voxel, path);
  if (kind == "parts") return write_parts(voxel, path);
  if (kind == "flow") return write_flow(voxel, path);
  const auto maker = std::find_if(makers().begin(), makers().end(),
                                  [&](const auto& entry) { return entry.first == kind; });
  if (maker == makers().end()) {
    throw std::invalid_argument("unknown fixture '" + std::string(kind) + "'");
  }
  const GridBase::Ptr grid = maker->second(voxel);
  grid->setName(std::string(kind));
  grid->setTransform(kind == "sheared"
                         ? sheared(voxel)
                         : openvdb::math::Transform::createLinearTransform(voxel));
  openvdb::io::File(path).write(openvdb::GridCPtrVec{grid});
}

}  // namespace tet::test
