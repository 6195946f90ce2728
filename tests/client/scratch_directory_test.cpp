#include "client/command/process/scratch_directory.h"

#include <filesystem>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "tests/support/test_directory.h"

namespace tet::test {
namespace {

TEST(ScratchDirectory, GoesWithWhoeverHasItLast) {
  const TestDirectory folder;
  std::filesystem::path made;
  {
    auto scratch = ScratchDirectory::make(folder.file(""));
    ASSERT_TRUE(scratch.ok()) << scratch.status();
    const ScratchDirectory moved = *std::move(scratch);
    made = std::filesystem::path(moved.file("a")).parent_path();
    EXPECT_TRUE(std::filesystem::is_directory(made));
  }
  EXPECT_FALSE(std::filesystem::exists(made));
}

TEST(ScratchDirectory, SaysWhereItCannotBeMade) {
  const TestDirectory folder;
  const std::string nowhere = folder.file("nowhere");
  const absl::Status status = ScratchDirectory::make(nowhere).status();
  EXPECT_TRUE(absl::IsNotFound(status)) << status;
  EXPECT_NE(status.message().find(nowhere), std::string::npos) << status;
}

}  // namespace
}  // namespace tet::test
