#include "core/labels/sparse_sums.h"

#include <algorithm>

namespace tet {
namespace {

constexpr std::size_t kHoldsNothing = ~std::size_t{0};

std::size_t steps_from(std::int32_t voxel, std::int32_t first) noexcept {
  return static_cast<std::size_t>(voxel - first);
}

const Taps& node_taps(const TapRow& row, int node) noexcept {
  return row.node[static_cast<std::size_t>(node)];
}

}  // namespace

void SparseSums::Row::clear() noexcept {
  first.clear();
  share.clear();
}

void SparseSums::Row::take(LabelSums& sums) {
  if (first.empty()) first.push_back(0);
  for (const std::uint16_t place : sums.seen()) share.push_back({place, sums.of(place)});
  first.push_back(static_cast<std::uint32_t>(share.size()));
  sums.clear();
}

void SparseSums::enter(std::span<const Label> voxel,
                       const VoxelWindow& window,
                       std::span<const Label> labels) {
  window_ = window;
  sums_.resize(labels.size());
  place_of_.resize(std::size_t{kJoker});
  for (std::size_t i = 0; i < labels.size(); ++i) {
    place_of_[labels[i]] = static_cast<std::uint16_t>(i);
  }
  // What is summed first lies side by side.
  place_.resize(voxel.size());
  const auto [nx, ny, nz] = window.size;
  const Label* from = voxel.data();
  for (std::size_t x = 0; x < nx; ++x) {
    for (std::size_t row = 0; row < ny * nz; ++row) place_[row * nx + x] = place_of_[*from++];
  }
}

void SparseSums::begin(const std::array<TapRow, 3>& taps) {
  std::size_t most = 0;
  for (const Taps& node : taps[1].node) most = std::max(most, node.count);
  if (rows_.size() >= most) return;  // the other kind of node reaches farther, by one
  rows_.resize(most);
  held_.resize(most);
}

void SparseSums::begin_slice() noexcept { std::ranges::fill(held_, kHoldsNothing); }

void SparseSums::sum_along_x(const TapRow& by, int x, std::size_t y, Row& row) {
  row.clear();
  const auto [nx, ny, nz] = window_.size;
  const std::span<const float> weight = by.weights_of(x);
  const std::uint16_t* place =
      place_.data() + y * nz * nx + steps_from(node_taps(by, x).first, window_.box.min.x);
  for (std::size_t z = 0; z < nz; ++z, place += nx) {
    for (std::size_t i = 0; i < weight.size(); ++i) sums_.add(place[i], weight[i]);
    row.take(sums_);
  }
}

void SparseSums::sum_along_y(const TapRow& by_x, int x, const TapRow& by, int y) {
  const std::size_t first = steps_from(node_taps(by, y).first, window_.box.min.y);
  const std::span<const float> weight = by.weights_of(y);
  for (std::size_t j = first; j < first + weight.size(); ++j) {
    const std::size_t slot = j % rows_.size();
    if (held_[slot] == j) continue;
    held_[slot] = j;
    sum_along_x(by_x, x, j, rows_[slot]);
  }
  sums_of_row_.clear();
  for (std::size_t z = 0; z < window_.size[2]; ++z) {
    for (std::size_t j = 0; j < weight.size(); ++j) {
      for (const auto [place, sum] : rows_[(first + j) % rows_.size()].at(z)) {
        sums_.add(place, weight[j] * sum);
      }
    }
    sums_of_row_.take(sums_);
  }
}

void SparseSums::sum_along_z(const TapRow& by, int z) noexcept {
  const std::size_t first = steps_from(node_taps(by, z).first, window_.box.min.z);
  const std::span<const float> weight = by.weights_of(z);
  for (std::size_t k = 0; k < weight.size(); ++k) {
    for (const auto [place, sum] : sums_of_row_.at(first + k)) {
      sums_.add(place, weight[k] * sum);
    }
  }
}

}  // namespace tet
