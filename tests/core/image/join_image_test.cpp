#include "core/image/join_image.h"

#include <cstddef>
#include <filesystem>
#include <string>
#include <sys/resource.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/test_directory.h"

namespace tet {
namespace {

using ::testing::HasSubstr;

namespace fs = std::filesystem;

/// The most memory that this process has had, in bytes.
std::size_t most_memory() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) << 10;
}

/// A header in `folder/own`, beside which there is `folder/other` with a file of eight bytes.
class JoinImage : public ::testing::Test {
 protected:
  JoinImage() {
    fs::create_directories(folder_.file("own/below"));
    fs::create_directory(folder_.file("other"));
    for (const char* name : {"own/below/a.raw", "other/a.raw"}) {
      test::write_bytes(folder_.file(name), "12345678");
    }
  }

  /// Joins a header whose data are in the file of that name.
  absl::Status join(const std::string& data_file) {
    const std::string header = folder_.file("own/a.nhdr"), joined = folder_.file("joined");
    test::write_bytes(header,
                      "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n"
                      "data file: " +
                          data_file + "\n");
    fs::remove(joined);
    return join_image(header, joined, cancellation_);
  }

  void link(const std::string& from, const std::string& to) const {
    fs::create_symlink(folder_.file(to), folder_.file(from));
  }

  test::TestDirectory folder_;
  Cancellation cancellation_;
};

TEST_F(JoinImage, TakesFilesBesideTheHeaderAndBelow) {
  for (const char* name : {"below/a.raw", "./below//a.raw", "below/./a.raw"}) {
    EXPECT_EQ(join(name), absl::OkStatus()) << name;
    EXPECT_THAT(test::read_bytes(folder_.file("joined")), HasSubstr("\n\n12345678"));
  }
}

TEST_F(JoinImage, FollowsNoLinksWhateverPartOfANameTheyAre) {
  link("own/file.raw", "other/a.raw");
  link("own/linked", "other");
  link("own/below/linked", "other");
  for (const char* name :
       {"file.raw", "linked/a.raw", "below/linked/a.raw", "linked/./a.raw"}) {
    const absl::Status status = join(name);
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << name;
    EXPECT_THAT(std::string(status.message()), HasSubstr("links are not followed")) << name;
  }
}

TEST_F(JoinImage, FollowsTheLinksThatTheHeaderItselfIsNamedBy) {
  ASSERT_EQ(join("below/a.raw"), absl::OkStatus());
  link("way", "own");
  EXPECT_EQ(join_image(folder_.file("way/a.nhdr"), folder_.file("again"), cancellation_),
            absl::OkStatus());
}

TEST_F(JoinImage, EndsWhereItIsCancelled) {
  cancellation_.cancel();
  EXPECT_EQ(join("below/a.raw").code(), absl::StatusCode::kCancelled);
}

TEST_F(JoinImage, CountsNoFilesOfNamesThatNothingOpens) {
  const std::size_t before = most_memory();
  const absl::Status status = join(std::string(60'000, 'a') + "%d 0 99999 1");
  EXPECT_THAT(std::string(status.message()), HasSubstr("60002 bytes; the limit is 4096"));
  EXPECT_LT(most_memory() - before, std::size_t{100} << 20);
  EXPECT_EQ(join(std::string(4000, 'a') + "%d 0 7 1").code(),
            absl::StatusCode::kFailedPrecondition);
}

TEST_F(JoinImage, TellsOfFilesThatAreMissingOrNone) {
  EXPECT_EQ(join("b.raw").code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(join("none/a.raw").code(), absl::StatusCode::kNotFound);
  for (const char* name : {"below", "below/a.raw/b", "."}) {
    EXPECT_EQ(join(name).code(), absl::StatusCode::kInvalidArgument) << name;
  }
}

}  // namespace
}  // namespace tet
