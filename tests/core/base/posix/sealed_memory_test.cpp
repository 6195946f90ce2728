#include "core/base/posix/sealed_memory.h"

#include <algorithm>
#include <fcntl.h>
#include <string>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>

#include <gtest/gtest.h>

#include "tests/support/test_directory.h"

namespace tet {
namespace {

constexpr std::size_t kBytes = 8192;

TEST(SealedMemory, IsReadAsItWasWrittenAndAsItIsWrittenLater) {
  const auto made = SealedMemory::make(kBytes);
  ASSERT_TRUE(made.ok()) << made.status();
  const auto read = SharedMemory::map(made->descriptor(), kBytes);
  ASSERT_TRUE(read.ok()) << read.status();
  made->bytes()[kBytes - 1] = std::byte{7};
  EXPECT_EQ(read->bytes()[kBytes - 1], std::byte{7});
  EXPECT_EQ(read->bytes()[0], std::byte{0});
}

TEST(SealedMemory, OutlivesItsMakerForAReader) {
  auto made = SealedMemory::make(kBytes);
  ASSERT_TRUE(made.ok()) << made.status();
  made->bytes()[1] = std::byte{3};
  const auto read = SharedMemory::map(made->descriptor(), kBytes);
  ASSERT_TRUE(read.ok()) << read.status();
  { const SealedMemory gone = *std::move(made); }
  EXPECT_EQ(read->bytes()[1], std::byte{3});
}

/// Pages that are there, in units of 512 bytes.
blkcnt_t blocks_of(const Descriptor& memory) {
  struct stat told {};
  EXPECT_EQ(::fstat(memory.number(), &told), 0);
  return told.st_blocks;
}

/// What a process that has no more than this descriptor could do to the memory; 0 is nothing.
int harm_of(const Descriptor& handed) noexcept {
  const int number = handed.number();
  void* const read = ::mmap(nullptr, kBytes, PROT_READ, MAP_SHARED, number, 0);
  if (::mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_SHARED, number, 0) != MAP_FAILED)
    return 1;
  if (read != MAP_FAILED && ::mprotect(read, kBytes, PROT_READ | PROT_WRITE) == 0) return 2;
  if (::pwrite(number, "x", 1, 0) == 1) return 3;
  if (::ftruncate(number, 0) == 0 || ::ftruncate(number, 2 * kBytes) == 0) return 4;
  if (::fallocate(number, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, 0, kBytes) == 0) return 5;
  if (::fcntl(number, F_ADD_SEALS, F_SEAL_WRITE) == 0) return 6;
  return 0;
}

/// Tells that, too, and whether it can have the file opened for writing after all.
int harm_of_stranger(const Descriptor& handed) noexcept {
  if (const int harm = harm_of(handed); harm != 0) return harm;
  const std::string path = "/proc/self/fd/" + std::to_string(handed.number());
  if (open_descriptor(path, O_RDWR).is_open()) return 7;
  if (::fchmod(handed.number(), 0600) == 0) return 8;
  return open_descriptor(path, O_RDWR).is_open() ? 9 : 0;
}

TEST(SealedMemory, ItsOwnUserCanDoNothingToWhatAnyMayRead) {
  const auto made = SealedMemory::make(kBytes);
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_EQ(harm_of(made->descriptor()), 0);
  const Descriptor again =
      open_descriptor("/proc/self/fd/" + std::to_string(made->descriptor().number()), O_RDWR);
  ASSERT_TRUE(again.is_open());
  EXPECT_EQ(harm_of(again), 0);
}

TEST(SealedMemory, AnotherUserCanDoNothingToWhatItIsHanded) {
  const auto made = SealedMemory::make(kBytes, Readers::kOtherUser);
  ASSERT_TRUE(made.ok()) << made.status();
  ASSERT_TRUE(made->can_be_given_up());
  EXPECT_EQ(harm_of(made->descriptor()), 0);
  if (::geteuid() != 0) GTEST_SKIP() << "only root can become another user";
  const pid_t child = ::fork();
  if (child == 0) {
    constexpr uid_t kNobody = 65534;
    ::_exit(::setresuid(kNobody, kNobody, kNobody) == 0 ? harm_of_stranger(made->descriptor())
                                                        : 100);
  }
  int ended = -1;
  ASSERT_EQ(::waitpid(child, &ended, 0), child);
  EXPECT_TRUE(WIFEXITED(ended));
  EXPECT_EQ(WEXITSTATUS(ended), 0);
}

TEST(SealedMemory, IsGivenUpWhoeverStillHasIt) {
  const auto made = SealedMemory::make(kBytes, Readers::kOtherUser);
  ASSERT_TRUE(made.ok()) << made.status();
  const auto read = SharedMemory::map(made->descriptor(), kBytes);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_FALSE(read->holds_pages());
  std::ranges::fill(made->bytes(), std::byte{5});
  EXPECT_EQ(read->bytes()[kBytes - 1], std::byte{5});
  EXPECT_EQ(blocks_of(made->descriptor()), blkcnt_t{kBytes / 512});
  made->give_up();
  EXPECT_EQ(blocks_of(made->descriptor()), 0);
  EXPECT_EQ(read->bytes()[kBytes - 1], std::byte{0});
}

TEST(SealedMemory, StaysWhereItsReadersMayBeItsOwnUser) {
  const auto made = SealedMemory::make(kBytes);
  ASSERT_TRUE(made.ok()) << made.status();
  const auto read = SharedMemory::map(made->descriptor(), kBytes);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_TRUE(read->holds_pages());
  made->bytes()[0] = std::byte{5};
  EXPECT_FALSE(made->can_be_given_up());
  made->give_up();
  EXPECT_EQ(read->bytes()[0], std::byte{5});
}

TEST(SharedMemory, KnowsItsDescriptors) {
  const auto made = SealedMemory::make(kBytes, Readers::kOtherUser);
  const auto other = SealedMemory::make(kBytes);
  ASSERT_TRUE(made.ok() && other.ok());
  const auto read = SharedMemory::map(made->descriptor(), kBytes);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_TRUE(read->is_of(made->descriptor(), kBytes));
  EXPECT_FALSE(read->is_of(made->descriptor(), kBytes / 2));
  EXPECT_FALSE(read->is_of(other->descriptor(), kBytes));
  EXPECT_FALSE(read->is_of(Descriptor(), kBytes));
}

TEST(SharedMemory, RefusesWhatIsShorterOrMayBecomeSo) {
  const auto refused = [](const Descriptor& descriptor, std::size_t bytes) {
    return SharedMemory::map(descriptor, bytes).status().code() ==
           absl::StatusCode::kInvalidArgument;
  };
  const auto made = SealedMemory::make(kBytes);
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_TRUE(refused(made->descriptor(), kBytes + 1));
  EXPECT_TRUE(refused(made->descriptor(), 0));

  const Descriptor unsealed(::memfd_create("unsealed", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  ASSERT_EQ(::posix_fallocate(unsealed.number(), 0, kBytes), 0);
  EXPECT_TRUE(refused(unsealed, kBytes));
  EXPECT_EQ(::fcntl(unsealed.number(), F_ADD_SEALS, F_SEAL_GROW | F_SEAL_WRITE), 0);
  EXPECT_TRUE(refused(unsealed, kBytes));

  const test::TestDirectory folder;
  const Descriptor file = open_descriptor(folder.file("file"), O_RDWR | O_CREAT);
  ASSERT_EQ(::posix_fallocate(file.number(), 0, kBytes), 0);
  EXPECT_TRUE(refused(file, kBytes));
  EXPECT_TRUE(refused(Descriptor(), kBytes));
}

}  // namespace
}  // namespace tet
