#include "core/vdb/decoder/sealed_block.h"

#include <cstring>
#include <fcntl.h>
#include <string>
#include <sys/mman.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tet {
namespace {

using testing::HasSubstr;

Descriptor memory_of(const std::string& bytes) {
  Descriptor memory = *make_sealable_memory();
  EXPECT_EQ(::write(memory.number(), bytes.data(), bytes.size()), std::ssize(bytes));
  return memory;
}

std::string refusal(const Descriptor& memory, std::uint64_t max_bytes = 1 << 20) {
  return std::string(SealedBlock::map(memory.number(), max_bytes).status().message());
}

TEST(SealedBlock, HoldsWhatWasWritten) {
  const Descriptor memory = memory_of("hello");
  ASSERT_TRUE(seal_memory(memory.number()).ok());
  const absl::StatusOr<SealedBlock> block = SealedBlock::map(memory.number(), 5);
  ASSERT_TRUE(block.ok()) << block.status();
  EXPECT_EQ(std::memcmp(block->bytes().data(), "hello", 5), 0);
  EXPECT_EQ(block->bytes().size(), 5U);
}

// Hosts that let no memory be run (vm.memfd_noexec) seal that, too, unasked.
TEST(SealedBlock, MayHaveMoreSealsThanItNeeds) {
  constexpr unsigned kNoExecSeal = 0x0008U;
  const Descriptor memory(
      ::memfd_create("hardened", MFD_CLOEXEC | MFD_ALLOW_SEALING | kNoExecSeal));
  if (!memory.is_open()) GTEST_SKIP() << "the kernel has no such memory";
  ASSERT_EQ(::write(memory.number(), "hello", 5), 5);
  ASSERT_TRUE(seal_memory(memory.number()).ok());
  const absl::StatusOr<SealedBlock> block = SealedBlock::map(memory.number(), 5);
  ASSERT_TRUE(block.ok()) << block.status();
  EXPECT_EQ(std::memcmp(block->bytes().data(), "hello", 5), 0);
}

TEST(SealedBlock, CannotBeChangedByAnyone) {
  const Descriptor memory = memory_of("hello");
  ASSERT_TRUE(seal_memory(memory.number()).ok());
  EXPECT_EQ(::pwrite(memory.number(), "x", 1, 0), -1);
  EXPECT_EQ(::ftruncate(memory.number(), 1), -1);
  EXPECT_EQ(::mmap(nullptr, 5, PROT_READ | PROT_WRITE, MAP_SHARED, memory.number(), 0),
            MAP_FAILED);
}

TEST(SealedBlock, IsNotSealedWhileSomebodyCanWriteIt) {
  const Descriptor memory = memory_of("hello");
  void* const window =
      ::mmap(nullptr, 5, PROT_READ | PROT_WRITE, MAP_SHARED, memory.number(), 0);
  EXPECT_FALSE(seal_memory(memory.number()).ok());
  ::munmap(window, 5);
}

TEST(SealedBlock, RefusesEverythingElse) {
  const Descriptor memory = memory_of("hello");
  EXPECT_THAT(refusal(memory), HasSubstr("not sealed"));
  ASSERT_EQ(::fcntl(memory.number(), F_ADD_SEALS, F_SEAL_WRITE | F_SEAL_GROW), 0);
  EXPECT_THAT(refusal(memory), HasSubstr("not sealed"));  // it could still shrink under us
  ASSERT_TRUE(seal_memory(memory.number()).ok());
  EXPECT_THAT(refusal(memory, 4), HasSubstr("has 5 bytes and may have 1 to 4"));
  const Descriptor empty = memory_of("");
  ASSERT_TRUE(seal_memory(empty.number()).ok());
  EXPECT_THAT(refusal(empty), HasSubstr("has 0 bytes"));
  const Descriptor sparse = memory_of("");
  ASSERT_EQ(::ftruncate(sparse.number(), 1 << 20), 0);
  ASSERT_TRUE(seal_memory(sparse.number()).ok());
  EXPECT_THAT(refusal(sparse), HasSubstr("has holes"));
}

}  // namespace
}  // namespace tet
