#include "core/transfer/compact_chunk.h"

#include <algorithm>
#include <cstring>
#include <string>
#include <utility>

#include <absl/strings/str_cat.h>

#include "core/base/byte_coding.h"
#include "core/plan/brick/fill_brick.h"
#include "core/plan/fill_watch.h"
#include "core/plan/mesh_workspace.h"
#include "core/stuffing/brick_geometry.h"
#include "core/stuffing/cut_tet.h"

namespace tet {
namespace {

/// Where a brick lies, in a brick's first byte.
enum Step : std::uint8_t { kNextAlongZ = 0, kJump = 1, kAnywhere = 2 };
constexpr std::uint8_t kStepBits = 0b11;
/// What a finest brick's nodes are, in its first byte.
enum Side : std::uint8_t {
  kOutsideBrick = 0 << 2,
  kInsideBrick = 1 << 2,
  kSurfaceBrick = 2 << 2
};
constexpr std::uint8_t kSideBits = 0b11 << 2;
constexpr std::uint8_t kHasLeaves = 1 << 4;
constexpr std::uint8_t kTagBits = kStepBits | kSideBits | kHasLeaves;

/// Coordinates stay within 2^27 bricks.
constexpr std::int32_t kMaxBrick = std::int32_t{1} << 27;

class Writer : public ByteWriter {
 public:
  using ByteWriter::ByteWriter;

  void zigzag(std::int64_t value) {
    varint(static_cast<std::uint64_t>(value << 1 ^ value >> 63));
  }
  void mask(const BrickMask& mask) {
    std::uint8_t empty = 0, full = 0;
    for (unsigned x = 0; x < 8; ++x) {
      empty |= static_cast<std::uint8_t>((mask.slice[x] == 0) << x);
      full |= static_cast<std::uint8_t>((~mask.slice[x] == 0) << x);
    }
    number(empty);
    number(full);
    for (const std::uint64_t slice : mask.slice) {
      if (slice != 0 && ~slice != 0) number(slice);
    }
  }
};

/// Writes bricks one after another.
class BrickEncoder {
 public:
  BrickEncoder(const CountedMesh& mesh,
               const PhiField& field,
               StuffingWorkspace& workspace,
               const Cancellation& cancellation,
               std::vector<std::byte>& bytes)
      : mesh_(mesh),
        workspace_(workspace),
        cancellation_(cancellation),
        sampler_(field),
        out_(bytes) {
    sampler_.stop_when(cancellation);
  }

  void write(BrickPlace place) {
    const OctreeLevel& level = mesh_.tree().levels[static_cast<std::size_t>(place.level)];
    const BrickMask& leaf = level.leaf[place.brick];
    const Side side = place.level == 0 ? side_of(place.brick) : kOutsideBrick;
    write_place(place, static_cast<std::uint8_t>(side | (leaf.any() ? kHasLeaves : 0)));
    if (leaf.any()) out_.mask(leaf);
    if (place.level > 0) out_.mask(level.refined[place.brick]);
    if (place.level > 0 && mesh_.rules().both_sides) {
      out_.mask(level.inside.empty() ? leaf : level.inside[place.brick]);
    }
    if (side == kSurfaceBrick) write_surface(place.brick);
  }

 private:
  Side side_of(std::size_t brick) const noexcept {
    if (mesh_.touches_surface(brick)) return kSurfaceBrick;
    return mesh_.stuffed(brick) == kAllInside ? kInsideBrick : kOutsideBrick;
  }

  void write_place(BrickPlace place, std::uint8_t rest) {
    const BrickCoord b =
        mesh_.tree().levels[static_cast<std::size_t>(place.level)].bricks[place.brick];
    const BrickCoord from = previous_;
    const bool same_level = place.level == level_;
    if (same_level && b == BrickCoord{from.x, from.y, from.z + 1}) {
      out_.number(static_cast<std::uint8_t>(rest | kNextAlongZ));
    } else if (same_level) {
      out_.number(static_cast<std::uint8_t>(rest | kJump));
      out_.zigzag(std::int64_t{b.x} - from.x);
      out_.zigzag(std::int64_t{b.y} - from.y);
      out_.zigzag(std::int64_t{b.z} - from.z);
    } else {
      out_.number(static_cast<std::uint8_t>(rest | kAnywhere));
      out_.number(static_cast<std::uint8_t>(place.level));
      for (const std::int32_t along : {b.x, b.y, b.z}) out_.number(along);
    }
    level_ = place.level;
    previous_ = b;
  }

  void write_surface(std::size_t brick) {
    const std::uint32_t surveyed = mesh_.stuffed(brick);
    const StuffedBrick& stuffed = mesh_.survey().stuffed[surveyed];
    for (const NodeKind kind : {kCorner, kCentre}) {
      out_.mask(stuffed.plus[kind]);
      out_.mask(stuffed.zero[kind]);
    }
    if (mesh_.rules().both_sides) {
      for (const BrickMask& fan : mesh_.survey().fans[surveyed]) out_.mask(fan);
    }
    const GeometrySizes sizes(stuffed);
    out_.varint(sizes.cuts);
    std::byte* const geometry = out_.extend(sizes.bytes());
    if (const std::byte* kept = mesh_.survey().geometry.of_brick[surveyed]) {
      std::copy_n(kept, sizes.bytes(), geometry);
      return;
    }
    stuff_brick(sampler_, mesh_.tree().levels[0].bricks[brick], mesh_.rules(), mesh_.restored(),
                workspace_);
    if (cancellation_.requested()) return;  // there was room for what was counted
    pack_geometry(workspace_.lattice, stuffed, geometry);
  }

  const CountedMesh& mesh_;
  StuffingWorkspace& workspace_;
  const Cancellation& cancellation_;
  PhiSampler sampler_;
  Writer out_;
  int level_ = -1;
  BrickCoord previous_;
};

absl::Status broken(const char* what) {
  return absl::DataLossError(absl::StrCat("a compact chunk is broken: ", what));
}

}  // namespace

class CompactBricks::Reader : public ByteReader {
 public:
  using ByteReader::ByteReader;

  std::int64_t zigzag() {
    const std::uint64_t value = varint();
    return static_cast<std::int64_t>(value >> 1) ^ -static_cast<std::int64_t>(value & 1);
  }
  BrickMask mask() {
    BrickMask mask;
    const auto empty = number<std::uint8_t>(), full = number<std::uint8_t>();
    if ((empty & full) != 0) fail();
    for (unsigned x = 0; x < 8; ++x) {
      if ((empty >> x & 1) != 0) continue;
      mask.slice[x] = (full >> x & 1) != 0 ? ~std::uint64_t{0} : number<std::uint64_t>();
    }
    return mask;
  }

  // Where the brick before lies.
  int level = -1;
  BrickCoord previous;
};

absl::Status CompactBricks::add(std::span<const std::byte> chunk) {
  // Kept as it came: the geometry within stays where it is.
  std::shared_ptr<std::byte[]> kept = std::make_unique_for_overwrite<std::byte[]>(chunk.size());
  std::ranges::copy(chunk, kept.get());
  Reader reader({kept.get(), chunk.size()});
  structure_.survey.geometry.blocks.push_back(std::move(kept));
  const std::uint64_t bricks = reader.varint();
  for (std::uint64_t i = 0; i < bricks; ++i) {
    if (absl::Status status = add_brick(reader); !status.ok()) return status;
    if (reader.failed()) return broken("it ends within a brick");
  }
  if (reader.failed() || !reader.at_end()) return broken("it does not end where it says");
  first_brick_.push_back(first_brick_.back() + bricks);
  return absl::OkStatus();
}

namespace {

/// The next brick's coordinate; beyond the limits where the bytes say nonsense.
template <class Reader>
std::array<std::int64_t, 3> read_place(Reader& reader, std::uint8_t step) {
  const BrickCoord from = reader.previous;
  if (step == kNextAlongZ) return {from.x, from.y, std::int64_t{from.z} + 1};
  std::array<std::int64_t, 3> at{from.x, from.y, from.z};
  if (step == kAnywhere) reader.level = reader.template number<std::uint8_t>();
  for (std::int64_t& along : at) {
    if (step == kAnywhere) {
      along = reader.template number<std::int32_t>();
    } else {
      along += std::clamp<std::int64_t>(reader.zigzag(), -4 * kMaxBrick, 4 * kMaxBrick);
    }
  }
  return at;
}

bool within_limits(const std::array<std::int64_t, 3>& at) {
  return std::ranges::all_of(at, [](std::int64_t v) { return std::abs(v) <= kMaxBrick; });
}

}  // namespace

absl::Status CompactBricks::add_brick(Reader& reader) {
  const auto tag = reader.number<std::uint8_t>();
  const std::uint8_t step = tag & kStepBits, side = tag & kSideBits;
  if ((tag & ~kTagBits) != 0 || step > kAnywhere || side > kSurfaceBrick) {
    return broken("a brick of an unknown kind");
  }
  if (reader.level < 0 && step != kAnywhere) return broken("its first brick is nowhere");
  const auto at = read_place(reader, step);
  const auto last_level = static_cast<int>(levels_.size()) - 1;
  if (reader.level < last_level) return broken("levels out of order");
  if (!within_limits(at)) return broken("a brick beyond index space");
  const BrickCoord brick{static_cast<std::int32_t>(at[0]), static_cast<std::int32_t>(at[1]),
                         static_cast<std::int32_t>(at[2])};
  if (reader.level > last_level) {
    if (reader.level > kMaxLevels) return broken("too many levels");
    // A mesh of one side alone has no brick of the finest ones.
    levels_.resize(static_cast<std::size_t>(reader.level) + 1);
  }
  OctreeLevel& level = levels_.back();
  if (!level.bricks.empty() && !(level.bricks.back() < brick)) {
    return broken("bricks out of order");
  }
  reader.previous = brick;
  level.bricks.push_back(brick);
  level.leaf.push_back((tag & kHasLeaves) != 0 ? reader.mask() : BrickMask{});
  level.refined.push_back(reader.level > 0 ? reader.mask() : BrickMask{});
  if (reader.level > 0) {
    if (both_sides_) level.inside.push_back(reader.mask());
    return side == 0 ? absl::OkStatus() : broken("a coarse brick at the surface");
  }
  if (side == kSurfaceBrick) return add_surface(reader);
  structure_.stuffed.push_back(side == kInsideBrick ? kAllInside : kAllOutside);
  return absl::OkStatus();
}

namespace {

/// Fractions, then the directions of `zeros` nodes.
absl::Status check_geometry(std::span<const std::byte> geometry, std::size_t zeros) {
  bool between = true;  // written so that no number at all is not between
  for (std::size_t at = 0; at < geometry.size() - zeros; at += sizeof(float)) {
    float fraction;
    std::memcpy(&fraction, &geometry[at], sizeof(fraction));
    between &= fraction >= 0 && fraction <= 1;
  }
  if (!between) return broken("a fraction that is not between 0 and 1");
  for (const std::byte direction : geometry.last(zeros)) {
    const auto d = static_cast<std::uint8_t>(direction);
    if (d >= kDirections && d != kUnmoved) return broken("an edge of an unknown direction");
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status CompactBricks::add_surface(Reader& reader) {
  Survey& survey = structure_.survey;
  Signs& signs = signs_.emplace_back();
  for (const NodeKind kind : {kCorner, kCentre}) {
    signs.plus[kind] = reader.mask();
    signs.zero[kind] = reader.mask();
    if ((signs.plus[kind] & signs.zero[kind]).any()) return broken("a node of two signs");
  }
  if (both_sides_) {
    for (BrickMask& fan : survey.fans.emplace_back()) fan = reader.mask();
  }
  const std::uint64_t cuts = reader.varint();
  if (cuts > kEdgeFamilies * kBrickCells) return broken("more cut points than edges");
  const GeometrySizes sizes(signs.zero[kCorner].count() + signs.zero[kCentre].count(), cuts);
  const auto geometry = reader.take(sizes.bytes());
  if (reader.failed()) return broken("it ends within a brick");
  if (auto status = check_geometry(geometry, sizes.zeros); !status.ok()) return status;
  structure_.stuffed.push_back(static_cast<std::uint32_t>(geometry_sizes_.size()));
  survey.geometry.of_brick.push_back(geometry.data());
  geometry_sizes_.push_back(sizes.bytes());
  return absl::OkStatus();
}

absl::StatusOr<CountedMesh> CompactBricks::count(const StuffingRules& rules, bool faces) && {
  if (levels_.empty()) return broken("there is no brick");
  for (OctreeLevel& level : levels_) level.index = BrickIndex(level.bricks);
  structure_.tree.levels = std::move(levels_);
  structure_.survey.stuffed.reserve(signs_.size());
  for (const Signs& signs : signs_) {
    structure_.survey.stuffed.push_back({signs.plus, signs.zero, {}});
  }
  CountedMesh mesh(std::move(structure_), rules, faces);
  for (std::size_t i = 0; i < geometry_sizes_.size(); ++i) {
    if (GeometrySizes(mesh.survey().stuffed[i]).bytes() != geometry_sizes_[i]) {
      return broken("cut points that do not fit the signs");
    }
  }
  return mesh;
}

CompactFrame compact_frame(const BrickPlan& plan) {
  return {plan.to_world(), plan.counted().mesh.rules()};
}

void encode_chunk(const BrickPlan& plan,
                  std::uint64_t index,
                  MeshWorkspace& workspace,
                  std::vector<std::byte>& bytes) {
  const ComparedMesh counted = plan.counted();
  const auto [begin, end] = plan.bricks_of_chunk(index);
  Writer(bytes).varint(end - begin);
  const FillWatch& watch = workspace.get<FillWatch>();
  BrickEncoder encoder(counted.mesh, counted.field, workspace.get<BrickScratch>().stuffing,
                       watch.cancellation(), bytes);
  for (std::size_t brick = begin; brick < end && !watch.stops(); ++brick) {
    encoder.write(counted.mesh.place(brick));
  }
}

}  // namespace tet
