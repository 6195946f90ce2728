#include "core/base/posix/atomic_file.h"

#include <filesystem>
#include <string>
#include <string_view>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "core/base/posix/folder.h"
#include "tests/core/base/posix/small_disk.h"
#include "tests/core/base/posix/temporary_folder.h"

namespace tet {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class AtomicFileTest : public test::TemporaryFolder {};

absl::Status write(AtomicFile& file, std::string_view text) {
  return file.write(std::as_bytes(std::span(text)));
}

TEST_F(AtomicFileTest, AppearsWhenCommitted) {
  absl::StatusOr<AtomicFile> file = AtomicFile::create(path("out"));
  ASSERT_TRUE(file.ok()) << file.status();
  ASSERT_TRUE(write(*file, "whole").ok());
  EXPECT_FALSE(fs::exists(path("out")));
  ASSERT_TRUE(file->commit().ok());
  EXPECT_EQ(contents(path("out")), "whole");
  EXPECT_THAT(names(), ElementsAre("out"));
}

TEST_F(AtomicFileTest, LeavesNothingWhenNotCommitted) {
  {
    absl::StatusOr<AtomicFile> file = AtomicFile::create(path("out"));
    ASSERT_TRUE(write(*file, "half").ok());
    EXPECT_EQ(names().size(), 1U);
  }
  EXPECT_THAT(names(), ElementsAre());
}

TEST_F(AtomicFileTest, KeepsTheOldFileUntilTheNewOneIsWhole) {
  ASSERT_TRUE(write_text_file(path("out"), "old").ok());
  {
    absl::StatusOr<AtomicFile> file = AtomicFile::create(path("out"));
    ASSERT_TRUE(write(*file, "half").ok());
  }
  EXPECT_EQ(contents(path("out")), "old");
  ASSERT_TRUE(write_text_file(path("out"), "new").ok());
  EXPECT_EQ(contents(path("out")), "new");
}

TEST_F(AtomicFileTest, FollowsASymbolicLink) {
  fs::create_directory(path("elsewhere"));
  ASSERT_TRUE(write_text_file(path("elsewhere/real"), "old").ok());
  fs::create_symlink(path("elsewhere/real"), path("link"));
  ASSERT_TRUE(write_text_file(path("link"), "new").ok());
  EXPECT_TRUE(fs::is_symlink(path("link")));
  EXPECT_EQ(contents(path("elsewhere/real")), "new");
}

TEST_F(AtomicFileTest, FollowsASymbolicLinkToWhatIsNotThereYet) {
  fs::create_symlink("next", path("link"));
  fs::create_symlink("file", path("next"));
  EXPECT_EQ(link_target(path("link")), fs::weakly_canonical(path("file")));
  ASSERT_TRUE(write_text_file(path("link"), "new").ok());
  EXPECT_TRUE(fs::is_symlink(path("link")) && fs::is_symlink(path("next")));
  EXPECT_EQ(fs::file_size(path("file")), 3U);
}

TEST_F(AtomicFileTest, TakesAPathWithoutADirectory) {
  const fs::path before = fs::current_path();
  fs::current_path(folder_);
  EXPECT_TRUE(write_text_file("plain", "text").ok());
  fs::current_path(before);
  EXPECT_EQ(contents(path("plain")), "text");
}

TEST_F(AtomicFileTest, TakesTheLongestNameThereIs) {
  EXPECT_TRUE(write_text_file(path(std::string(255, 'n')), "text").ok());
}

TEST_F(AtomicFileTest, RefusesADirectoryThatIsNotThere) {
  const absl::Status status = check_can_create(path("missing/out"));
  EXPECT_EQ(status.code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(std::string(status.message()), HasSubstr("No such file or directory"));
  EXPECT_THAT(std::string(status.message()), HasSubstr(path("missing/out")));
}

TEST_F(AtomicFileTest, RefusesWhatIsNotARegularFile) {
  EXPECT_EQ(check_can_create(folder_).code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(check_can_create("/dev/null").code(), absl::StatusCode::kFailedPrecondition);
}

TEST_F(AtomicFileTest, CheckingLeavesNothingBehind) {
  EXPECT_TRUE(check_can_create(path("out")).ok());
  EXPECT_THAT(names(), ElementsAre());
}

TEST_F(AtomicFileTest, WritesAtAnyPlace) {
  absl::StatusOr<AtomicFile> file = AtomicFile::create(path("out"));
  file->move_to(4);
  ASSERT_TRUE(write(*file, "later").ok());
  file->move_to(0);
  ASSERT_TRUE(write(*file, "now ").ok());
  ASSERT_TRUE(file->commit().ok());
  EXPECT_EQ(contents(path("out")), "now later");
}

TEST_F(AtomicFileTest, KeepsTheOldFileWhenTheDiskIsFull) {
  ASSERT_TRUE(write_text_file(path("out"), "old").ok());
  {
    const test::SmallDisk disk(10);
    const absl::Status status = write_text_file(path("out"), "more than there is room for");
    EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
    EXPECT_THAT(std::string(status.message()), HasSubstr(path("out")));
  }
  EXPECT_EQ(contents(path("out")), "old");
  EXPECT_THAT(names(), ElementsAre("out"));
}

TEST_F(AtomicFileTest, DoesNotReplaceADirectory) {
  absl::StatusOr<AtomicFile> file = AtomicFile::create(path("out"));
  ASSERT_TRUE(write(*file, "text").ok());
  fs::create_directory(path("out"));
  EXPECT_EQ(file->commit().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_TRUE(fs::is_directory(path("out")));
}

TEST_F(AtomicFileTest, IsCalledAsItsOwnerLikesUntilItIsWhole) {
  auto file = AtomicFile::create_at(path("out"), {"", ".part", 0600, io_error});
  ASSERT_TRUE(file.ok());
  EXPECT_EQ(file->temporary_path().extension(), ".part");
  EXPECT_EQ(*file->file().mode() & 0777U, 0600U);
  ASSERT_TRUE(file->file().write_at(0, "text").ok());
  ASSERT_TRUE(file->commit_unsynced().ok());
  ASSERT_TRUE(sync_folder(folder_, io_error).ok());
  EXPECT_EQ(contents(path("out")), "text");
}

TEST_F(AtomicFileTest, HasANameOfItsOwnBesideThatOfACopyOfTheProcess) {
  ASSERT_TRUE(AtomicFile::create(path("out")).ok());  // whatever is remembered from now on
  const pid_t child = ::fork();
  if (child == 0) {
    const absl::StatusOr<AtomicFile> file = AtomicFile::create(path("out"));
    ::_exit(file.ok() ? 0 : 1);  // and leaves it there
  }
  int status = -1;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  const std::vector<std::string> of_child = names();
  const absl::StatusOr<AtomicFile> file = AtomicFile::create(path("out"));
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(of_child.size(), 1U);
  EXPECT_NE(file->temporary_path().filename(), of_child.front());
}

TEST_F(AtomicFileTest, MayBeMoved) {
  {
    absl::StatusOr<AtomicFile> file = AtomicFile::create(path("out"));
    ASSERT_TRUE(write(*file, "half").ok());
    const AtomicFile moved = *std::move(file);
    EXPECT_EQ(names().size(), 1U);
  }
  EXPECT_THAT(names(), ElementsAre());
}

}  // namespace
}  // namespace tet
