#include "server/streams/frame_leaves.h"

#include <bit>
#include <cstddef>
#include <cstring>
#include <utility>

#include <absl/status/statusor.h>
#include <absl/strings/str_cat.h>

#include "proto/convert/status.h"

namespace tet {

namespace {

static_assert(std::endian::native == std::endian::little);

/// What a message takes beside its values and its leaves: its place in a list, and what the
/// allocator adds to each block.
constexpr std::size_t kMessageBytes = 2 * sizeof(std::vector<float>) + 2 * sizeof(void*);

/// Voxels of leaves begin at multiples of 8.
absl::StatusOr<BrickCoord> brick_of(const v1::LeafUpdate& leaf) {
  for (const auto& [axis, voxel] :
       {std::pair("x", leaf.x()), std::pair("y", leaf.y()), std::pair("z", leaf.z())}) {
    if (voxel % kBrickEdge == 0) continue;
    return invalid_field(absl::StrCat(axis, " ", voxel, " is not a multiple of ", kBrickEdge));
  }
  return BrickCoord{leaf.x() / kBrickEdge, leaf.y() / kBrickEdge, leaf.z() / kBrickEdge};
}

}  // namespace

FrameLeaves::FrameLeaves(const std::string& before, std::shared_ptr<CallCharge> charge)
    : charge_(std::move(charge)) {
  digest_.add(before);
}

absl::Status FrameLeaves::add(const v1::RemeshFrame& message) {
  if (message.leaves().empty()) return absl::OkStatus();  // nothing is kept of it
  std::size_t bytes = 0;
  for (const v1::LeafUpdate& leaf : message.leaves()) bytes += leaf.values().size();
  // The lists of leaves and of messages may have room for twice as many.
  const auto count = static_cast<std::size_t>(message.leaves_size());
  const absl::Status charged =
      charge_->add(bytes + 2 * count * sizeof(LeafValues) + kMessageBytes);
  if (!charged.ok()) return charged;
  values_.emplace_back(bytes / sizeof(float));
  float* to = values_.back().data();
  for (const v1::LeafUpdate& leaf : message.leaves()) {
    const absl::Status added = add_leaf(leaf, to);
    if (!added.ok()) return within_field(absl::StrCat("leaves[", leaves_.size(), "]"), added);
  }
  return absl::OkStatus();
}

absl::Status FrameLeaves::add_leaf(const v1::LeafUpdate& leaf, float*& to) {
  const auto brick = brick_of(leaf);
  if (!brick.ok()) return brick.status();
  const std::size_t bytes = leaf.values().size(), count = bytes / sizeof(float);
  if (bytes % sizeof(float) != 0 || (count != 1 && count != kBrickCells)) {
    return invalid_field(absl::StrCat("values has ", bytes, " bytes; a leaf has 2048, or 4"));
  }
  std::memcpy(to, leaf.values().data(), bytes);
  leaves_.push_back({*brick, {to, count}});
  to += count;
  digest_.add(absl::StrCat("\n", leaf.x(), " ", leaf.y(), " ", leaf.z(), " ", bytes, "\n"));
  digest_.add(leaf.values());
  return absl::OkStatus();
}

}  // namespace tet
