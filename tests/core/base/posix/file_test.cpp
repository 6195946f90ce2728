#include "core/base/posix/file.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <filesystem>
#include <pthread.h>
#include <string>
#include <sys/stat.h>
#include <thread>

#include <gmock/gmock.h>

#include "core/base/posix/transfer.h"
#include "tests/core/base/posix/small_disk.h"
#include "tests/core/base/posix/temporary_folder.h"

namespace tet {
namespace {

using test::SmallDisk;
using ::testing::HasSubstr;

class FileTest : public test::TemporaryFolder {
 protected:
  File make(const std::string& name) const {
    auto file = File::open(path(name), O_RDWR | O_CREAT, io_error);
    EXPECT_TRUE(file.ok()) << file.status();
    return *std::move(file);
  }
};

TEST_F(FileTest, ReadsWhatWasWritten) {
  File file = make("a");
  ASSERT_TRUE(file.write_at(3, "after a hole").ok());
  std::string text(100, '.');
  const auto count = file.read_at(0, text);
  ASSERT_TRUE(count.ok());
  EXPECT_EQ(text.substr(0, *count), std::string("\0\0\0after a hole", 15));
  EXPECT_EQ(*file.size(), 15U);
}

TEST_F(FileTest, AppendsAndTruncates) {
  auto file = File::open(path("a"), O_RDWR | O_CREAT | O_APPEND, io_error);
  ASSERT_TRUE(file.ok());
  ASSERT_TRUE(file->append("one two").ok());
  ASSERT_TRUE(file->truncate(4).ok());
  ASSERT_TRUE(file->append("three").ok());
  EXPECT_EQ(contents(path("a")), "one three");
}

TEST_F(FileTest, MakesFilesWithTheModeThatIsAskedFor) {
  auto file = File::open(path("a"), O_RDWR | O_CREAT, io_error, 0600);
  ASSERT_TRUE(file.ok());
  EXPECT_EQ(*file->mode() & 0777U, 0600U);
}

TEST_F(FileTest, IsNotInheritedByOtherPrograms) {
  const File file = make("a");
  EXPECT_EQ(::fcntl(file.descriptor().number(), F_GETFD), FD_CLOEXEC);
}

TEST_F(FileTest, SaysWhichFileIsMissing) {
  const auto file = File::open(path("missing"), O_RDONLY, io_error);
  EXPECT_EQ(file.status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(file.status().message(),
            "cannot open " + path("missing") + ": No such file or directory");
}

TEST_F(FileTest, LetsItsOwnerTellErrors) {
  const IoErrorTeller tell = [](std::string_view action, const std::filesystem::path& path) {
    return absl::DataLossError(std::string(action) + "|" + path.filename().string());
  };
  EXPECT_EQ(File::open(path("missing"), O_RDONLY, tell).status(),
            absl::DataLossError("open|missing"));
  auto read_only = File::open(folder_, O_RDONLY | O_DIRECTORY, tell);
  ASSERT_TRUE(read_only.ok());
  EXPECT_EQ(read_only->append("x"),
            absl::DataLossError("write to|" + folder_.filename().string()));
}

TEST_F(FileTest, SaysThatTheDiskIsFull) {
  File file = make("a");
  const SmallDisk disk(100);
  ASSERT_TRUE(file.write_at(0, std::string(100, 'x')).ok());
  const absl::Status status = file.write_at(100, "y");
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(status.message()), HasSubstr(path("a")));
  EXPECT_EQ(file.reserve(1000).code(), absl::StatusCode::kResourceExhausted);
}

// The system takes the bytes up to the limit and says how many: the rest is tried again.
TEST_F(FileTest, FailsWhenTheDiskFillsInTheMiddleOfAWrite) {
  File file = make("a");
  const SmallDisk disk(100);
  EXPECT_TRUE(absl::IsResourceExhausted(file.write_at(0, std::string(150, 'x'))));
  EXPECT_EQ(*file.size(), 100U);
}

TEST_F(FileTest, ReservesItsWholeSize) {
  File file = make("a");
  ASSERT_TRUE(file.reserve(1 << 20).ok());
  EXPECT_EQ(*file.size(), std::uint64_t{1} << 20);
  ASSERT_TRUE(file.reserve(0).ok());
  EXPECT_EQ(*file.size(), 0U);
}

TEST_F(FileTest, IsHeldByOneOrSharedByMany) {
  File one = make("a"), two = make("a"), three = make("a");
  EXPECT_TRUE(*one.lock(FileLock::kShared));
  EXPECT_TRUE(*two.lock(FileLock::kShared));
  EXPECT_FALSE(*three.lock(FileLock::kAlone));
  ASSERT_TRUE(one.close().ok());
  ASSERT_TRUE(two.close().ok());
  EXPECT_TRUE(*three.lock(FileLock::kAlone));
}

TEST_F(FileTest, NoticesThatItsPathLeadsElsewhere) {
  const File file = make("a");
  EXPECT_TRUE(file.is_at_its_path());
  std::filesystem::rename(path("a"), path("b"));
  EXPECT_FALSE(file.is_at_its_path());
  make("a");
  EXPECT_FALSE(file.is_at_its_path());
}

TEST_F(FileTest, HandsItsDescriptorOn) {
  File file = make("a");
  const int number = file.descriptor().number();
  const Descriptor taken = std::move(file).take_descriptor();
  EXPECT_EQ(taken.number(), number);
}

TEST(DescriptorTest, TellsThatClosingFailed) {
  Descriptor descriptor(1 << 20);  // beyond what any process has open
  EXPECT_FALSE(descriptor.close());
  EXPECT_EQ(errno, EBADF);
  EXPECT_FALSE(descriptor.is_open());
  EXPECT_TRUE(descriptor.close());
}

/// A pipe holds 64 KiB: a longer write goes in pieces, and waits in between.
TEST(TransferTest, GoesOnAfterSignalsAndShortWrites) {
  struct sigaction handler {};
  struct sigaction before {};
  handler.sa_handler = [](int) {};  // without SA_RESTART, so that system calls end early
  ASSERT_EQ(::sigaction(SIGUSR1, &handler, &before), 0);
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  const Descriptor out(ends[0]), in(ends[1]);
  const std::string text(std::size_t{1} << 20, 'x');
  std::atomic<bool> written{false};
  std::thread writer([&] {
    EXPECT_TRUE(write_all(in.number(), std::as_bytes(std::span(text))));
    written = true;
  });
  std::string came;
  std::array<char, 4096> buffer{};
  while (came.size() < text.size()) {
    if (!written) ::pthread_kill(writer.native_handle(), SIGUSR1);
    const ssize_t count = ::read(out.number(), buffer.data(), buffer.size());
    ASSERT_GT(count, 0);
    came.append(buffer.data(), static_cast<std::size_t>(count));
  }
  writer.join();
  ::sigaction(SIGUSR1, &before, nullptr);
  EXPECT_EQ(came, text);
}

TEST(TransferTest, TellsWhyNothingCouldBeRead) {
  std::array<std::byte, 8> bytes{};
  EXPECT_EQ(read_all_at(-1, 0, bytes), -1);
  EXPECT_EQ(errno, EBADF);
  EXPECT_FALSE(write_all(-1, bytes));
}

}  // namespace
}  // namespace tet
