#include "core/files/atomic_file.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <unistd.h>

#include <gmock/gmock.h>

namespace tet {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class AtomicFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "atomic_file_XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    directory_ = pattern;
  }
  void TearDown() override { fs::remove_all(directory_); }

  std::string path(const std::string& name) const { return directory_ / name; }

  static std::string contents(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(directory_)) {
      names.push_back(entry.path().filename());
    }
    return names;
  }

  fs::path directory_;
};

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

TEST_F(AtomicFileTest, TakesAPathWithoutADirectory) {
  const fs::path before = fs::current_path();
  fs::current_path(directory_);
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
  EXPECT_EQ(check_can_create(directory_).code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(check_can_create("/dev/null").code(), absl::StatusCode::kFailedPrecondition);
}

TEST_F(AtomicFileTest, CheckingLeavesNothingBehind) {
  EXPECT_TRUE(check_can_create(path("out")).ok());
  EXPECT_THAT(names(), ElementsAre());
}

}  // namespace
}  // namespace tet
