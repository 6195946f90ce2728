#include "core/volume/flat_volume.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/volume/check_transform.h"
#include "core/volume/grid_info.h"
#include "core/volume/volume_builder.h"

namespace tet {
namespace {

constexpr std::array<char, 8> kMagic{'t', 'e', 't', '-', 'v', 'o', 'l', '\n'};
constexpr std::uint32_t kVersion = 2;

/// Bricks beyond these have voxels beyond kMaxVoxelCoord; the arithmetic on those within is
/// safe.
constexpr std::int32_t kMaxBrickCoord = kMaxVoxelCoord / kBrickEdge;

struct Header {
  std::array<char, 8> magic = kMagic;
  std::uint32_t version = kVersion;
  std::uint32_t kind = 0;
  std::uint64_t total_bytes = 0;
  std::uint64_t name_bytes = 0;
  std::uint64_t brick_count = 0;
  std::uint64_t constant_count = 0;
  std::uint64_t cube_count = 0;
  float background = 0;
  std::uint32_t kind_source = 0;
  VoxelTransform transform;
};
static_assert(sizeof(VoxelTransform) == 13 * sizeof(double));
static_assert(sizeof(Header) == 64 + sizeof(VoxelTransform));
static_assert(sizeof(ConstantBrick) == 16 && sizeof(ConstantCube) == 20);

constexpr std::uint64_t kBrickBytes = kBrickCells * sizeof(float);

bool same_bits(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}

/// The region's constant bricks that say something. One that says nothing stands for a region
/// that would else have none.
void gather_constants(const Region& region, float background, std::vector<ConstantBrick>& out) {
  bool empty = true;
  for (std::int32_t i = 0; i < 4096; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const BrickCoord brick{region.min.x + i / 256, region.min.y + i / 16 % 16,
                           region.min.z + i % 16};
    const bool constant = region.brick_index[at] == Region::kConstant;
    const bool differs = constant && !same_bits(region.constant[at], background);
    if (differs) out.push_back({brick, region.constant[at]});
    empty = empty && constant && !differs;
  }
  if (empty) out.push_back({region.min, background});
}

std::vector<ConstantBrick> constants_of(const Volume& volume) {
  std::vector<ConstantBrick> constants;
  for (const Region& region : volume.regions) {
    gather_constants(region, volume.background, constants);
  }
  std::sort(constants.begin(), constants.end(),
            [](const ConstantBrick& a, const ConstantBrick& b) { return a.brick < b.brick; });
  return constants;
}

std::uint64_t block_bytes(const Header& header) {
  return column_bytes(sizeof(Header)) + column_bytes(header.name_bytes) +
         column_bytes(header.brick_count * sizeof(BrickCoord)) +
         column_bytes(header.brick_count * kBrickBytes) +
         column_bytes(header.constant_count * sizeof(ConstantBrick)) +
         column_bytes(header.cube_count * sizeof(ConstantCube));
}

Header header_of(const Volume& volume, std::size_t constant_count) {
  Header header;
  header.kind = static_cast<std::uint32_t>(volume.kind);
  header.kind_source = static_cast<std::uint32_t>(volume.kind_source);
  header.name_bytes = volume.name.size();
  header.brick_count = volume.bricks.size();
  header.constant_count = constant_count;
  header.cube_count = volume.cubes.size();
  header.background = volume.background;
  header.transform = volume.transform;
  header.total_bytes = block_bytes(header);
  return header;
}

absl::Status wrong_volume(const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat("the flat volume is not valid: ", what));
}

absl::StatusOr<Header> read_header(FlatReader& reader, std::size_t block_size) {
  const auto bytes = reader.column<std::byte>(sizeof(Header));
  if (!bytes) return wrong_volume(absl::StrFormat("%d bytes hold no header", block_size));
  Header header;
  std::memcpy(&header, bytes->data(), sizeof(Header));
  if (header.magic != kMagic) return wrong_volume("it does not begin with its magic number");
  if (header.version != kVersion) {
    return wrong_volume(
        absl::StrFormat("its version is %d and only %d can be read", header.version, kVersion));
  }
  if (header.total_bytes != block_size) {
    return wrong_volume(
        absl::StrFormat("it claims %d bytes and has %d", header.total_bytes, block_size));
  }
  if (header.kind > static_cast<std::uint32_t>(VolumeKind::kVectorField)) {
    return wrong_volume(absl::StrFormat("kind %d is none", header.kind));
  }
  if (header.kind_source > static_cast<std::uint32_t>(KindSource::kNobody)) {
    return wrong_volume(absl::StrFormat("source %d of its kind is none", header.kind_source));
  }
  if (header.name_bytes > kMaxGridNameBytes) {
    return wrong_volume(absl::StrFormat("its name has %d bytes and the limit is %d",
                                        header.name_bytes, kMaxGridNameBytes));
  }
  if (absl::Status s = check_transform(header.transform); !s.ok()) return s;
  return header;
}

/// The columns of a block, still in it.
struct Columns {
  std::span<const char> name;
  std::span<const BrickCoord> bricks;
  std::span<const float> values;
  std::span<const ConstantBrick> constants;
  std::span<const ConstantCube> cubes;
};

absl::StatusOr<Columns> read_columns(const Header& header, FlatReader& reader) {
  const auto name = reader.column<char>(header.name_bytes);
  if (!name) return wrong_volume("its name does not fit in it");
  const auto bricks = reader.column<BrickCoord>(header.brick_count);
  if (!bricks)
    return wrong_volume(absl::StrFormat("%d bricks do not fit in it", header.brick_count));
  const auto values = reader.column<float>(header.brick_count, kBrickCells);
  if (!values)
    return wrong_volume(absl::StrFormat("%d bricks do not fit in it", header.brick_count));
  const auto constants = reader.column<ConstantBrick>(header.constant_count);
  if (!constants) {
    return wrong_volume(
        absl::StrFormat("%d constant bricks do not fit in it", header.constant_count));
  }
  const auto cubes = reader.column<ConstantCube>(header.cube_count);
  if (!cubes)
    return wrong_volume(absl::StrFormat("%d cubes do not fit in it", header.cube_count));
  if (!reader.at_end()) return wrong_volume("bytes follow its last column");
  const bool empty = bricks->empty() && constants->empty() && cubes->empty();
  if (empty && has_inside(static_cast<VolumeKind>(header.kind)))
    return wrong_volume("it is empty");
  return Columns{*name, *bricks, *values, *constants, *cubes};
}

bool within_limits(BrickCoord b) {
  return std::max({b.x, b.y, b.z}) <= kMaxBrickCoord &&
         std::min({b.x, b.y, b.z}) >= -kMaxBrickCoord;
}

/// `place(item)` is where an item lies; each lies after the one before it.
template <class T, class Place>
absl::Status check_order(std::span<const T> items, const char* what, const Place& place) {
  for (std::size_t i = 1; i < items.size(); ++i) {
    if (!(place(items[i - 1]) < place(items[i]))) {
      return wrong_volume(
          absl::StrFormat("%s %d does not come after the one before it", what, i));
    }
  }
  return absl::OkStatus();
}

template <class T, class Place>
absl::Status check_bricks(std::span<const T> items, const char* what, const Place& place) {
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (!within_limits(place(items[i]))) {
      return wrong_volume(absl::StrFormat("%s %d is beyond voxel %d", what, i, kMaxVoxelCoord));
    }
  }
  return check_order(items, what, place);
}

absl::Status check_places(const Columns& columns) {
  const auto brick = [](BrickCoord b) { return b; };
  if (absl::Status s = check_bricks(columns.bricks, "brick", brick); !s.ok()) return s;
  const auto constant = [](const ConstantBrick& c) { return c.brick; };
  if (absl::Status s = check_bricks(columns.constants, "constant brick", constant); !s.ok()) {
    return s;
  }
  return check_order(columns.cubes, "cube", [](const ConstantCube& c) { return c.min; });
}

/// How many regions the bricks and constants lie in: each takes 32 KiB, a constant 16 bytes.
std::uint64_t count_regions(const Columns& columns) {
  std::vector<BrickCoord> regions;
  const auto add = [&](BrickCoord b) {
    constexpr std::int32_t kMask = ~(Region::kEdgeBricks - 1);
    const BrickCoord region{b.x & kMask, b.y & kMask, b.z & kMask};
    if (regions.empty() || regions.back() != region) regions.push_back(region);
  };
  for (const BrickCoord brick : columns.bricks) add(brick);
  for (const ConstantBrick& constant : columns.constants) add(constant.brick);
  std::sort(regions.begin(), regions.end());
  return static_cast<std::uint64_t>(
      std::distance(regions.begin(), std::unique(regions.begin(), regions.end())));
}

absl::Status check_budget(const Columns& columns, std::uint64_t max_bytes) {
  const std::uint64_t bytes =
      columns.bricks.size() * (kBrickBytes + sizeof(BrickCoord) + sizeof(ValueRange)) +
      columns.cubes.size_bytes() + count_regions(columns) * sizeof(Region);
  if (bytes <= max_bytes && columns.bricks.size() < Region::kConstant) return absl::OkStatus();
  return absl::ResourceExhaustedError(
      absl::StrFormat("its %d bricks would take %d bytes and the limit is %d",
                      columns.bricks.size(), bytes, max_bytes));
}

Volume copy_columns(const Header& header,
                    const Columns& columns,
                    const Cancellation& cancellation) {
  Volume volume;
  volume.name.assign(columns.name.begin(), columns.name.end());
  volume.kind = static_cast<VolumeKind>(header.kind);
  volume.kind_source = static_cast<KindSource>(header.kind_source);
  volume.transform = header.transform;
  volume.background = header.background;
  copy_column(columns.bricks, cancellation, volume.bricks);
  copy_column(columns.values, cancellation, volume.values);
  volume.cubes.assign(columns.cubes.begin(), columns.cubes.end());
  return volume;
}

}  // namespace

std::uint64_t flat_volume_bytes(const Volume& volume) {
  return block_bytes(header_of(volume, volume.regions.size() * 4096));
}

absl::Status write_flat_volume(const Volume& volume, const ByteSink& sink) {
  const std::vector<ConstantBrick> constants = constants_of(volume);
  const Header header = header_of(volume, constants.size());
  FlatWriter writer(sink);
  writer.add(std::span<const Header>(&header, 1));
  writer.add(std::span<const char>(volume.name));
  writer.add(std::span<const BrickCoord>(volume.bricks));
  writer.add(std::span<const float>(volume.values));
  writer.add(std::span<const ConstantBrick>(constants));
  writer.add(std::span<const ConstantCube>(volume.cubes));
  return writer.status();
}

absl::StatusOr<Volume> read_flat_volume(std::span<const std::byte> block,
                                        std::uint64_t max_bytes,
                                        const Cancellation& cancellation) {
  FlatReader reader(block);
  const absl::StatusOr<Header> header = read_header(reader, block.size());
  if (!header.ok()) return header.status();
  const absl::StatusOr<Columns> columns = read_columns(*header, reader);
  if (!columns.ok()) return columns.status();
  if (absl::Status s = check_places(*columns); !s.ok()) return s;
  if (absl::Status s = check_budget(*columns, max_bytes); !s.ok()) return s;
  Volume volume = copy_columns(*header, *columns, cancellation);
  if (absl::Status s = check_cancelled(cancellation); !s.ok()) return s;
  return index_volume(std::move(volume), {columns->constants.begin(), columns->constants.end()},
                      cancellation);
}

}  // namespace tet
