#include "core/base/posix/atomic_folder.h"

#include <array>
#include <string>
#include <string_view>

#include <gmock/gmock.h>

#include "tests/core/base/posix/temporary_folder.h"

namespace tet {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr std::array<std::string_view, 2> kKnown{"points", "zones"};

class AtomicFolderTest : public test::TemporaryFolder {
 protected:
  absl::Status put(const AtomicFolder& folder, std::string_view name, std::string_view text) {
    absl::StatusOr<AtomicFile> file = folder.file(name);
    if (!file.ok()) return file.status();
    if (auto status = file->write(std::as_bytes(std::span(text))); !status.ok()) return status;
    return file->commit_unsynced();
  }
  absl::Status write_folder(const std::string& to, std::string_view text) {
    absl::StatusOr<AtomicFolder> folder = AtomicFolder::create(to, kKnown);
    if (!folder.ok()) return folder.status();
    if (auto status = put(*folder, "points", text); !status.ok()) return status;
    return folder->commit();
  }
};

TEST_F(AtomicFolderTest, AppearsWhenCommitted) {
  absl::StatusOr<AtomicFolder> folder = AtomicFolder::create(path("out"), kKnown);
  ASSERT_TRUE(folder.ok()) << folder.status();
  ASSERT_TRUE(put(*folder, "points", "whole").ok());
  EXPECT_FALSE(fs::exists(path("out")));
  ASSERT_TRUE(folder->commit().ok());
  EXPECT_EQ(contents(path("out/points")), "whole");
}

TEST_F(AtomicFolderTest, LeavesNothingWhenNotCommitted) {
  {
    absl::StatusOr<AtomicFolder> folder = AtomicFolder::create(path("out"), kKnown);
    ASSERT_TRUE(put(*folder, "points", "half").ok());
  }
  EXPECT_THAT(names(), ElementsAre());
}

TEST_F(AtomicFolderTest, ReplacesAnOlderOneOfItsKindWholly) {
  fs::create_directory(path("out"));
  ASSERT_TRUE(write_text_file(path("out/points"), "old").ok());
  ASSERT_TRUE(write_text_file(path("out/zones"), "old").ok());
  ASSERT_TRUE(write_folder(path("out/"), "new").ok());
  EXPECT_EQ(contents(path("out/points")), "new");
  EXPECT_FALSE(fs::exists(path("out/zones")));
  EXPECT_THAT(names(), ElementsAre("out"));
}

TEST_F(AtomicFolderTest, DoesNotReplaceAFolderWithOtherFilesInIt) {
  fs::create_directory(path("thesis"));
  ASSERT_TRUE(write_text_file(path("thesis/chapter"), "words").ok());
  const absl::Status status = write_folder(path("thesis"), "new");
  EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(status.message()), HasSubstr("holds chapter"));
  EXPECT_EQ(contents(path("thesis/chapter")), "words");
  EXPECT_THAT(names(), ElementsAre("thesis"));
}

TEST_F(AtomicFolderTest, FollowsASymbolicLinkToWhatIsNotThereYet) {
  fs::create_symlink("next", path("link"));
  fs::create_symlink("folder", path("next"));
  EXPECT_TRUE(check_can_create_folder(path("link"), kKnown).ok());
  EXPECT_EQ(write_folder(path("link"), "new"), absl::OkStatus());
  EXPECT_TRUE(fs::is_symlink(path("link")) && fs::is_symlink(path("next")));
  EXPECT_EQ(contents(path("folder/points")), "new");
}

TEST_F(AtomicFolderTest, IsNoFile) {
  ASSERT_TRUE(write_text_file(path("out"), "text").ok());
  EXPECT_EQ(write_folder(path("out"), "new").code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(contents(path("out")), "text");
}

TEST_F(AtomicFolderTest, SaysThatThereIsNoFolderToPutItIn) {
  EXPECT_EQ(write_folder(path("no/out"), "new").code(), absl::StatusCode::kNotFound);
}

TEST_F(AtomicFolderTest, FollowsASymbolicLink) {
  fs::create_directories(path("elsewhere/real"));
  fs::create_symlink(path("elsewhere/real"), path("link"));
  ASSERT_TRUE(write_folder(path("link"), "new").ok());
  EXPECT_TRUE(fs::is_symlink(path("link")));
  EXPECT_EQ(contents(path("elsewhere/real/points")), "new");
}

/// A file with text in it that is not committed yet.
AtomicFile file_with(const std::string& path, std::string_view text) {
  absl::StatusOr<AtomicFile> file = AtomicFile::create(path);
  EXPECT_TRUE(file.ok()) << file.status();
  EXPECT_TRUE(file->write(std::as_bytes(std::span(text))).ok());
  return *std::move(file);
}

TEST_F(AtomicFolderTest, TwoFilesTakeTheirNamesTogether) {
  ASSERT_TRUE(write_text_file(path("index"), "old index").ok());
  ASSERT_TRUE(write_text_file(path("body"), "old body").ok());
  AtomicFile body = file_with(path("body"), "new body");
  AtomicFile index = file_with(path("index"), "new index");
  ASSERT_TRUE(commit_together(body, index).ok());
  EXPECT_EQ(contents(path("body")), "new body");
  EXPECT_EQ(contents(path("index")), "new index");
  EXPECT_EQ(names().size(), 2U);
}

TEST_F(AtomicFolderTest, TwoFilesOfWhichOneCannotBeLeaveTheOldOnesAsTheyWere) {
  for (const char* const blocked : {"body", "index"}) {
    const std::string other = blocked == std::string("body") ? "index" : "body";
    ASSERT_TRUE(write_text_file(path(other), "old").ok());
    {
      AtomicFile body = file_with(path("body"), "new body");
      AtomicFile index = file_with(path("index"), "new index");
      // A folder that is not empty takes the name in the meantime, and cannot be renamed over.
      fs::create_directories(path(blocked) + "/taken");
      const absl::Status status = commit_together(body, index);
      EXPECT_FALSE(status.ok()) << blocked;
    }
    EXPECT_EQ(contents(path(other)), "old") << blocked;
    EXPECT_EQ(names().size(), 2U) << blocked;
    fs::remove_all(path("body"));
    fs::remove_all(path("index"));
  }
}

}  // namespace
}  // namespace tet
