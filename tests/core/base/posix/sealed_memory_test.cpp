#include "core/base/posix/sealed_memory.h"

#include <fcntl.h>
#include <sys/mman.h>
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
