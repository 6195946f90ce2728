#include "core/volume/flat_volume.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/byte_buffer.h"
#include "core/volume/grid_info.h"
#include "core/volume/volume_builder.h"
#include "tests/support/volume_fixtures.h"

namespace tet {
namespace {

using testing::HasSubstr;

constexpr std::uint64_t kPlenty = std::uint64_t{1} << 30;

/// Where the header has what; all counts are 64 bits wide.
enum Field : std::size_t {
  kMagic = 0,
  kVersion = 8,
  kKind = 12,
  kTotal = 16,
  kNameBytes = 24,
  kBrickCount = 32,
  kConstantCount = 40,
  kCubeCount = 48,
  kBackground = 56,
  kKindSource = 60,
  kLinear = 64,
  kTranslation = 64 + 72,
  kVoxelSize = 64 + 96,
  kHeaderEnd = 64 + 104,
};

/// A block as a program that means no harm writes it.
std::string flat(const Volume& volume) {
  std::string block;
  const absl::Status written = write_flat_volume(volume, [&](std::span<const std::byte> bytes) {
    block.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return absl::OkStatus();
  });
  EXPECT_TRUE(written.ok()) << written;
  return block;
}

absl::StatusOr<Volume> read(const std::string& block,
                            std::uint64_t max_bytes = kPlenty,
                            const Cancellation& cancellation = Cancellation()) {
  ByteBuffer aligned(block.size());
  std::memcpy(aligned.bytes().data(), block.data(), block.size());
  return read_flat_volume(aligned.bytes(), max_bytes, cancellation);
}

template <class T>
void put(std::string& block, std::size_t at, T value) {
  std::memcpy(block.data() + at, &value, sizeof(T));
}

/// To the last bit: of two zeros, too, and of what is not a number.
template <class T>
bool same_bytes(const T& a, const T& b) {
  return std::ranges::equal(std::as_bytes(std::span(&a, 1)), std::as_bytes(std::span(&b, 1)));
}

bool same(const Region& a, const Region& b) {
  return a.min == b.min && a.brick_index == b.brick_index && same_bytes(a.constant, b.constant);
}

void expect_same(const Volume& a, const Volume& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_TRUE(same_bytes(a.transform, b.transform));
  EXPECT_EQ(a.background, b.background);
  EXPECT_EQ(a.bricks, b.bricks);
  EXPECT_EQ(a.values, b.values);
  const auto same_range = [](ValueRange x, ValueRange y) {
    return x.min == y.min && x.max == y.max;
  };
  EXPECT_TRUE(std::equal(a.ranges.begin(), a.ranges.end(), b.ranges.begin(), b.ranges.end(),
                         same_range));
  EXPECT_TRUE(
      std::equal(a.regions.begin(), a.regions.end(), b.regions.begin(), b.regions.end(), same));
  const auto same_cube = [](const ConstantCube& x, const ConstantCube& y) {
    return x.min == y.min && x.edge == y.edge && x.value == y.value;
  };
  EXPECT_TRUE(
      std::equal(a.cubes.begin(), a.cubes.end(), b.cubes.begin(), b.cubes.end(), same_cube));
}

/// A narrow band with constant bricks inside.
Volume ball(int radius, std::int32_t half_box) {
  const VoxelBox box{{-half_box, -half_box, -half_box}, {half_box, half_box, half_box}};
  Volume volume = test::narrow_band_volume(
      box, 3,
      [radius](VoxelCoord v) {
        return static_cast<float>(std::hypot(v.x, v.y, v.z)) - static_cast<float>(radius);
      },
      test::scaled(0.25));
  volume.name = "ball";
  return volume;
}

/// Few of everything: two bricks, two constants, two cubes.
Volume sample() {
  VolumeBuilder builder(VolumeKind::kFogVolume, 0.5F, test::scaled(2));
  std::array<float, kBrickCells> values;
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i);
  builder.add_brick({0, 0, 0}, values);
  builder.add_brick({-3, 1, 2}, values);
  builder.add_constant_brick({1, 1, 1}, 2);
  builder.add_constant_brick({40, 1, 1}, 3);
  builder.add_constant_cube({1280, 0, 0}, 128, 4);
  builder.add_constant_cube({-4096, -4096, 0}, 4096, 5);
  Volume volume = *std::move(builder).build();
  volume.name = "density";
  return volume;
}

/// Where a sample's columns begin.
constexpr std::size_t kName = 192;
constexpr std::size_t kBricks = kName + 64;
constexpr std::size_t kValues = kBricks + 64;
constexpr std::size_t kConstants = kValues + 2 * 2048;
constexpr std::size_t kCubes = kConstants + 64;

TEST(FlatVolume, ReadsBackEqual) {
  expect_same(*read(flat(sample())), sample());
  const Volume band = ball(20, 30);
  const absl::StatusOr<Volume> back = read(flat(band));
  ASSERT_TRUE(back.ok()) << back.status();
  expect_same(*back, band);
}

TEST(FlatVolume, KeepsRegionsOfBackgroundAndTheSignOfZero) {
  VolumeBuilder builder(VolumeKind::kLevelSet, 0.0F);
  builder.add_constant_brick({0, 0, 0}, 0.0F);
  builder.add_constant_brick({20, 0, 0}, -0.0F);
  const Volume volume = *std::move(builder).build();
  const absl::StatusOr<Volume> back = read(flat(volume));
  ASSERT_TRUE(back.ok()) << back.status();
  expect_same(*back, volume);
}

TEST(FlatVolume, SaysBeforehandHowManyBytesItTakesAtMost) {
  for (const Volume& volume : {sample(), ball(20, 30)}) {
    EXPECT_LE(flat(volume).size(), flat_volume_bytes(volume));
  }
}

TEST(FlatVolume, PassesOnWhatTheSinkSays) {
  int pieces = 0;
  const absl::Status status = write_flat_volume(sample(), [&](std::span<const std::byte>) {
    return ++pieces < 3 ? absl::OkStatus() : absl::ResourceExhaustedError("full");
  });
  EXPECT_TRUE(absl::IsResourceExhausted(status));
  EXPECT_EQ(pieces, 3);
}

TEST(FlatVolume, RefusesEveryTruncationAndEveryAddition) {
  const std::string whole = flat(sample());
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(read(whole.substr(0, size)).ok()) << size;
    std::string cut = whole.substr(0, size);
    if (size >= kTotal + 8) put<std::uint64_t>(cut, kTotal, size);
    EXPECT_FALSE(read(cut).ok()) << size;
  }
  std::string longer = whole + std::string(64, '\0');
  EXPECT_FALSE(read(longer).ok());
  put<std::uint64_t>(longer, kTotal, longer.size());
  EXPECT_THAT(std::string(read(longer).status().message()),
              HasSubstr("follow its last column"));
}

TEST(FlatVolume, RefusesABlockThatIsNotAligned) {
  const std::string block = flat(sample());
  ByteBuffer memory(block.size() + 8);
  std::memcpy(memory.bytes().data() + 8, block.data(), block.size());
  EXPECT_FALSE(read_flat_volume(memory.bytes().subspan(8), kPlenty).ok());
}

struct Lie {
  std::string what;
  std::function<void(std::string&)> tell;
};

template <class T>
Lie field(std::string what, std::size_t at, T value) {
  return {std::move(what), [at, value](std::string& block) { put(block, at, value); }};
}

std::vector<Lie> lies() {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  std::vector<Lie> all{
      field<char>("magic", kMagic, 'x'),
      field<std::uint32_t>("version", kVersion, 1),
      field<std::uint32_t>("kind", kKind, 4),
      field<std::uint32_t>("source of the kind", kKindSource, 4),
      field<float>("background", kBackground, kNan),
      field<double>("nan in the map", kLinear, std::nan("")),
      field<double>("infinite map", kLinear, kInf),
      field<double>("map beyond double's range", kLinear, 1e300),
      field<double>("voxels without an edge", kLinear, 0),
      field<double>("voxels as long as none are", kLinear + 8, 1e5),
      field<double>("translation", kTranslation + 16, -kInf),
      field<double>("voxel size of other voxels", kVoxelSize, 1),
      field<double>("voxel size that is none", kVoxelSize, std::nan("")),
      field<char>("padding after the header", kHeaderEnd, 1),
      field<char>("padding after the name", kName + 7, 1),
      field<std::int32_t>("bricks out of order", kBricks, 1),
      field<std::int32_t>("brick too far", kBricks, std::numeric_limits<std::int32_t>::min()),
      field<std::int32_t>("brick far out", kBricks + 20, kMaxVoxelCoord / 8),
      field<std::int32_t>("brick farther out", kBricks + 12, 1 << 30),
      field<float>("value", kValues, kNan),
      field<float>("last value", kConstants - 4, std::numeric_limits<float>::infinity()),
      field<std::int32_t>("constants out of order", kConstants, 41),
      field<std::int32_t>("constant too far", kConstants + 16, 1 << 28),
      field<std::int32_t>("constant at the end of int32", kConstants + 16, 0x7FFFFFFF),
      field<float>("constant's value", kConstants + 12, kNan),
      field<std::int32_t>("cubes out of order", kCubes, 4096),
      field<std::int32_t>("cube off its grid", kCubes + 20, 1281),
      field<std::int32_t>("cube too far", kCubes + 20, 0x7FFFFF80),
      field<std::int32_t>("cube of another edge", kCubes + 12, 64),
      field<std::int32_t>("cube of negative edge", kCubes + 12, -128),
      field<std::int32_t>("cube that holds a region", kCubes + 20, 0),
      field<float>("cube's value", kCubes + 16, kNan),
  };
  for (const std::size_t at : {kTotal, kNameBytes, kBrickCount, kConstantCount, kCubeCount}) {
    for (const std::uint64_t count :
         {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{3}, std::uint64_t{1} << 31,
          std::uint64_t{1} << 32, (std::uint64_t{1} << 61) + 2, ~std::uint64_t{0}}) {
      all.push_back(
          field("count at " + std::to_string(at) + " is " + std::to_string(count), at, count));
    }
  }
  all.push_back({"constant in a brick's place", [](std::string& block) {
                   for (std::size_t i = 0; i < 3; ++i) put(block, kConstants + 4 * i, 0);
                 }});
  return all;
}

TEST(FlatVolume, RefusesEveryLie) {
  const std::string truth = flat(sample());
  ASSERT_EQ(truth.size(), kCubes + 64);
  for (const Lie& lie : lies()) {
    std::string block = truth;
    lie.tell(block);
    EXPECT_FALSE(read(block).ok()) << lie.what;
  }
}

TEST(FlatVolume, HoldsAllItsPromisesWhateverByteIsChanged) {
  const std::string truth = flat(sample());
  for (std::size_t at = 0; at < truth.size(); ++at) {
    if (at >= kValues + 64 && at < kConstants - 64) continue;  // one value is like another
    for (const char bits : {'\x01', '\x80', '\xFF'}) {
      std::string block = truth;
      block[at] = static_cast<char>(block[at] ^ bits);
      const absl::StatusOr<Volume> volume = read(block);
      if (volume.ok()) expect_same(*read(flat(*volume)), *volume);
    }
  }
}

TEST(FlatVolume, RefusesNamesBeyondTheLimit) {
  Volume volume = sample();
  volume.name = std::string(kMaxGridNameBytes, 'n');
  EXPECT_TRUE(read(flat(volume)).ok());
  volume.name += 'n';
  EXPECT_THAT(std::string(read(flat(volume)).status().message()), HasSubstr("limit is 1024"));
}

TEST(FlatVolume, RefusesAVolumeOfNothing) {
  EXPECT_THAT(std::string(read(flat(Volume{})).status().message()), HasSubstr("it is empty"));
  Volume field;
  field.kind = VolumeKind::kVectorField;
  EXPECT_EQ(read(flat(field))->kind, VolumeKind::kVectorField) << "which may be";
}

TEST(FlatVolume, LooksAtEachMebibyteWhetherItIsCancelled) {
  constexpr int kMany = 4096;  // 8 MiB of values
  VolumeBuilder builder(VolumeKind::kLevelSet, 1);
  std::array<float, kBrickCells> values;
  values.fill(-1);
  for (int i = 0; i < kMany; ++i) builder.add_brick({i, 0, 0}, values);
  const std::string block = flat(*std::move(builder).build());
  const auto looks_until = [&](int last) {
    std::atomic<int> looks{0};
    const Cancellation cancellation(Cancellation::Clock::time_point::max(),
                                    [&] { return ++looks >= last; });
    const absl::Status status = read(block, kPlenty, cancellation).status();
    EXPECT_EQ(absl::IsCancelled(status), looks >= last) << status;
    return looks.load();
  };
  const int all = looks_until(std::numeric_limits<int>::max());
  EXPECT_GE(all, 8 + 8) << "when it is copied, and when its values are looked at";
  // Threads may look as often again.
  for (int last = 1; last < 16; ++last) EXPECT_LT(looks_until(last), last + 80) << last;
}

TEST(FlatVolume, CountsTheRegionsThatScatteredConstantsWouldTake) {
  VolumeBuilder builder(VolumeKind::kLevelSet, 1);
  for (int i = 0; i < 100; ++i) builder.add_constant_brick({i * 16, 0, 0}, 2);
  const std::string block = flat(*std::move(builder).build());
  EXPECT_LT(block.size(), 2000U);
  EXPECT_TRUE(read(block, 100 * sizeof(Region)).ok());
  const absl::Status status = read(block, 100 * sizeof(Region) - 1).status();
  EXPECT_TRUE(absl::IsResourceExhausted(status)) << status;
}

}  // namespace
}  // namespace tet
