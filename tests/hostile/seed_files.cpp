#include "tests/hostile/seed_files.h"

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>

#include "core/base/posix/descriptor.h"
#include "core/vdb/openvdb/vdb_grids.h"
#include "tests/support/vdb_bytes.h"
#include "tests/support/vdb_fixtures.h"

namespace tet::test {
namespace {

using openvdb::Coord;
using openvdb::FloatGrid;
using openvdb::GridBase;
using openvdb::io::COMPRESS_ACTIVE_MASK;
using openvdb::io::COMPRESS_BLOSC;
using openvdb::io::COMPRESS_ZIP;

/// The uuid is random; a campaign must not depend on it.
void clear_uuid(std::string& bytes) {
  constexpr std::size_t kUuidAt = 21;
  const std::string uuid = "00000000-0000-0000-0000-000000000000";
  bytes.replace(kUuidAt, uuid.size(), uuid);
}

SeedFile seed(const std::string& name,
              const openvdb::GridCPtrVec& grids,
              std::uint32_t compression = COMPRESS_BLOSC | COMPRESS_ACTIVE_MASK,
              bool offsets = true) {
  std::string bytes = vdb_bytes(grids, {compression, offsets});
  clear_uuid(bytes);
  return make_seed(name, std::move(bytes));
}

/// A narrow band around a ball over two lower nodes; what is inactive within it is negative.
FloatGrid::Ptr ball(const std::string& name, int radius = 6) {
  constexpr int kHalfBand = 2;
  const FloatGrid::Ptr grid = FloatGrid::create(kHalfBand);
  grid->setName(name);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  const Coord centre(60, 60, 124);
  const int extent = radius + kHalfBand;
  Coord c;
  for (c.x() = -extent; c.x() <= extent; ++c.x()) {
    for (c.y() = -extent; c.y() <= extent; ++c.y()) {
      for (c.z() = -extent; c.z() <= extent; ++c.z()) {
        const double distance = c.asVec3d().length() - radius;
        if (distance <= -kHalfBand) grid->tree().setValueOff(centre + c, -kHalfBand);
        if (std::abs(distance) < kHalfBand) {
          grid->tree().setValueOn(centre + c, static_cast<float>(distance));
        }
      }
    }
  }
  return grid;
}

/// OpenVDB compresses with zlib what is of no class.
FloatGrid::Ptr classless(FloatGrid::Ptr grid, bool half = false) {
  grid->setGridClass(openvdb::GRID_UNKNOWN);
  grid->setSaveFloatAsHalf(half);
  return grid;
}

FloatGrid::Ptr tiles() {
  const FloatGrid::Ptr grid = FloatGrid::create(1);
  grid->setName("tiles");
  grid->tree().root().addTile(Coord(0, 0, 4096), -1, true);
  grid->tree().root().addTile(Coord(-4096, 0, 0), 1, false);
  grid->tree().addTile(2, Coord(128, 0, 0), -1, true);
  grid->tree().addTile(2, Coord(256, 0, 0), -2, false);
  grid->tree().addTile(1, Coord(8, 0, 0), -3, true);
  grid->tree().setValueOn(Coord(1, 2, 3), -4);
  return grid;
}

template <class GridT>
typename GridT::Ptr single_voxel(const typename GridT::ValueType& value) {
  const auto grid = GridT::create();
  grid->setName("voxel");
  grid->tree().setValueOn(Coord(1, 2, 3), value);
  return grid;
}

openvdb::GridCPtrVec instances() {
  const FloatGrid::Ptr first = ball("first", 4);
  const FloatGrid::Ptr second = first->copyWithNewTree();
  second->setTree(first->treePtr());
  second->setName("second");
  return {first, second, tiles()};
}

FloatGrid::Ptr transformed(const openvdb::math::Transform::Ptr& transform) {
  const FloatGrid::Ptr grid = single_voxel<FloatGrid>(-1);
  grid->setTransform(transform);
  return grid;
}

openvdb::math::Transform::Ptr rotated() {
  const auto transform = openvdb::math::Transform::createLinearTransform(0.5);
  transform->postRotate(0.7, openvdb::math::X_AXIS);
  transform->postTranslate({1, 2, 3});
  return transform;
}

/// A grid of another kind, as tests/support makes it.
GridBase::Ptr fixture(const std::string& kind, double voxel) {
  std::string path = std::filesystem::temp_directory_path() / "hostile_seed.XXXXXX";
  const Descriptor file(::mkstemp(path.data()));
  write_fixture(kind, voxel, path);
  openvdb::io::File archive(path);
  archive.open(/*delayLoad=*/false);
  GridBase::Ptr grid = archive.readGrid(kind);
  archive.close();
  std::filesystem::remove(path);
  return grid;
}

}  // namespace

std::vector<SeedFile> seed_files() {
  openvdb::initialize();
  constexpr std::uint32_t kMasked = COMPRESS_ACTIVE_MASK;
  const auto frustum = openvdb::math::Transform::createFrustumTransform(
      openvdb::BBoxd({-9, -9, -9}, {9, 9, 9}), 0.5, 20, 1);
  std::vector<SeedFile> seeds;
  seeds.push_back(seed("blosc", {ball("ball")}));
  seeds.push_back(seed("blosc-unmasked", {ball("ball", 4)}, COMPRESS_BLOSC));
  seeds.push_back(seed("blosc-half", {classless(ball("ball"), true)}));
  seeds.push_back(seed("zip", {classless(ball("ball"))}, COMPRESS_ZIP | kMasked));
  seeds.push_back(seed("zip-unmasked-half", {classless(ball("ball", 4), true)}, COMPRESS_ZIP));
  seeds.push_back(seed("stored", {ball("ball")}, kMasked));
  seeds.push_back(seed("stored-half", {classless(ball("ball"), true)}, kMasked));
  seeds.push_back(seed("stream", {ball("ball")}, COMPRESS_BLOSC | kMasked, false));
  seeds.push_back(seed("tiles", {tiles()}));
  seeds.push_back(seed("tiles-stored", {tiles()}, kMasked));
  seeds.push_back(seed("instances", instances()));
  seeds.push_back(seed("vectors", {fixture("vec3", 0.8), tiles()}));
  seeds.push_back(seed("bits", {single_voxel<openvdb::BoolGrid>(true), tiles()}));
  seeds.push_back(seed("points", {fixture("points", 0.8), tiles()}));
  seeds.push_back(seed("rotated", {transformed(rotated())}));
  seeds.push_back(seed("frustum", {transformed(frustum)}));
  seeds.push_back(seed("empty", {FloatGrid::create(1)}));
  return seeds;
}

}  // namespace tet::test
