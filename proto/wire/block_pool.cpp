#include "proto/wire/block_pool.h"

#include <algorithm>
#include <cstdlib>
#include <new>
#include <utility>

namespace tet {

namespace {
constexpr std::align_val_t kAlignment{64};

struct FreeAligned {
  void operator()(std::byte* bytes) const noexcept { ::operator delete[](bytes, kAlignment); }
};
}  // namespace

struct BlockPool::Block {
  explicit Block(std::size_t size) : bytes(new (kAlignment) std::byte[size]) {}

  std::unique_ptr<std::byte[], FreeAligned> bytes;
  std::shared_ptr<Shelf> shelf;  ///< where it belongs, while it is out; null: to be freed
  std::shared_ptr<void> held;    ///< while it is out
};

struct BlockPool::Shelf {
  const std::size_t block_bytes;
  const std::size_t max_idle;
  mutable std::mutex mutex;
  std::vector<std::unique_ptr<Block>> idle;

  Shelf(std::size_t size, std::size_t most) : block_bytes(size), max_idle(most) {
    idle.reserve(max_idle);
  }

  std::unique_ptr<Block> take() {
    const std::lock_guard lock(mutex);
    if (idle.empty()) return nullptr;
    std::unique_ptr<Block> block = std::move(idle.back());
    idle.pop_back();
    return block;
  }

  void give_back(std::unique_ptr<Block> block) {
    const std::lock_guard lock(mutex);
    if (idle.size() < max_idle) idle.push_back(std::move(block));
  }

  /// What gRPC calls when the last slice of a block is gone.
  static void release(void* released) {
    std::unique_ptr<Block> block(static_cast<Block*>(released));
    const std::shared_ptr<Shelf> shelf = std::move(block->shelf);
    const std::shared_ptr<void> held = std::move(block->held);  // to go after the block is back
    if (shelf != nullptr) shelf->give_back(std::move(block));
  }
};

BlockPool::BlockPool(std::size_t block_bytes, std::size_t max_idle)
    : shelf_(std::make_shared<Shelf>(block_bytes, max_idle)) {}

grpc::Slice BlockPool::take(std::size_t size, std::shared_ptr<void> held) {
  const bool fits = size <= shelf_->block_bytes;
  std::unique_ptr<Block> block = fits ? shelf_->take() : nullptr;
  if (block == nullptr) block = std::make_unique<Block>(std::max(size, shelf_->block_bytes));
  if (fits) block->shelf = shelf_;
  block->held = std::move(held);
  std::byte* const bytes = block->bytes.get();
  return grpc::Slice(bytes, size, Shelf::release, block.release());
}

std::size_t BlockPool::idle() const {
  const std::lock_guard lock(shelf_->mutex);
  return shelf_->idle.size();
}

}  // namespace tet
