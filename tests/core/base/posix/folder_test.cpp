#include "core/base/posix/folder.h"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>

#include "tests/core/base/posix/temporary_folder.h"

namespace tet {
namespace {

namespace fs = std::filesystem;

class FolderTest : public test::TemporaryFolder {};

TEST_F(FolderTest, MakesThoseAboveAndAcceptsThoseThatAreThere) {
  ASSERT_TRUE(make_folder(path("a/b/c"), 0750, io_error).ok());
  EXPECT_TRUE(fs::is_directory(path("a/b/c")));
  EXPECT_TRUE(make_folder(path("a/b/c"), 0750, io_error).ok());
}

TEST_F(FolderTest, DoesNotMakeOneInAFile) {
  std::ofstream(path("a")) << "text";
  EXPECT_FALSE(make_folder(path("a/b"), 0750, io_error).ok());
}

TEST_F(FolderTest, MovesAFileOntoAnother) {
  std::ofstream(path("a")) << "new";
  std::ofstream(path("b")) << "old";
  ASSERT_TRUE(move_file(path("a"), path("b"), io_error).ok());
  EXPECT_EQ(contents(path("b")), "new");
  EXPECT_FALSE(fs::exists(path("a")));
}

TEST_F(FolderTest, DoesNotMoveAFileOntoADirectory) {
  std::ofstream(path("a")) << "text";
  fs::create_directory(path("b"));
  const absl::Status status = move_file(path("a"), path("b"), io_error);
  EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(status.message(), "cannot move " + path("a") + ": Is a directory");
  EXPECT_EQ(contents(path("a")), "text");
}

TEST_F(FolderTest, SyncsOnlyWhatIsThere) {
  EXPECT_TRUE(sync_folder(folder_, io_error).ok());
  EXPECT_TRUE(absl::IsNotFound(sync_folder(path("missing"), io_error)));
}

TEST(FolderOfTest, IsTheOneThatTheNameIsIn) {
  EXPECT_EQ(folder_of("a/b"), "a");
  EXPECT_EQ(folder_of("b"), ".");
  EXPECT_EQ(folder_of("/b"), "/");
}

}  // namespace
}  // namespace tet
