// What finding a patch takes of memory: in this program all that is allocated is counted.
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <malloc.h>
#include <new>
#include <random>

#include <gtest/gtest.h>

#include "core/transfer/mesh_patch.h"
#include "tests/core/plan/mesh_patches.h"
#include "tests/support/solids.h"

namespace {

std::atomic<std::uint64_t> held{0}, most_held{0};

void* counted(void* memory) {
  if (memory == nullptr) throw std::bad_alloc();
  const std::uint64_t now = held += malloc_usable_size(memory);
  std::uint64_t most = most_held;
  while (most < now && !most_held.compare_exchange_weak(most, now)) {
  }
  return memory;
}

void give_back(void* memory) noexcept {
  held -= malloc_usable_size(memory);
  std::free(memory);
}

}  // namespace

void* operator new(std::size_t size) { return counted(std::malloc(size)); }
void* operator new(std::size_t size, std::align_val_t align) {
  void* memory = nullptr;
  return counted(posix_memalign(&memory, static_cast<std::size_t>(align), size) == 0 ? memory
                                                                                     : nullptr);
}
void operator delete(void* memory) noexcept { give_back(memory); }
void operator delete(void* memory, std::size_t) noexcept { give_back(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { give_back(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  give_back(memory);
}

namespace tet::mesh_patch_test {
namespace {

/// Every eighth value has the other sign: of each brick some thousand runs are as they were.
Volume changed_everywhere(Volume volume) {
  std::mt19937 random(3);
  for (float& value : volume.values) {
    if (random() % 8 == 0) value = -value;
  }
  return volume;
}

TEST(PatchMemory, IsLessThanThatOfThePlanHoweverManyRunsAreKept) {
  const Volume signs = test::random_signs(64, 8);
  const Plan earlier = plan_of(signs, {}), now = plan_of(changed_everywhere(signs), {});
  ASSERT_TRUE(earlier && now);
  const auto taken = [&](PatchDetail detail, std::size_t most_runs) {
    const std::uint64_t before = held;
    most_held = before;
    const auto patch = MeshPatch::between(as_bricks(earlier), as_bricks(now), Cancellation(),
                                          detail, {.most_runs = most_runs, .least_kept = 0});
    // In so many runs bricks are kept as a whole, or not at all.
    EXPECT_TRUE(patch && patch->kept().vertices.size() + patch->kept().tets.size() < 100);
    return most_held - before;
  };
  // All runs take 16 MB, and the plan 6.8.
  for (const PatchDetail detail : kDetails) {
    EXPECT_LT(taken(detail, 100'000), now->bytes());
    EXPECT_LT(taken(detail, 10'000), now->bytes() / 2);
  }
}

}  // namespace
}  // namespace tet::mesh_patch_test
