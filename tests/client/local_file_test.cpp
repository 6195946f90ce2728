#include "client/library/local_file.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/wire/sha256.h"
#include "tests/support/test_directory.h"

namespace tet {
namespace {

using testing::HasSubstr;

const Cancellation kNever;

TEST(LocalFile, IsNamedByAllOfItsBytes) {
  const test::TestDirectory directory;
  const std::string path = directory.file("grid");
  const std::string bytes(std::size_t{3} << 20, 'x');  // several reads
  test::write_bytes(path, bytes);
  const absl::StatusOr<LocalFile> file = name_file(path, kNever);
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->size_bytes, bytes.size());
  Sha256 digest;
  digest.add(bytes);
  EXPECT_EQ(file->name, name_of_grid(digest.finish_hex()));
}

TEST(LocalFile, DoesNotEndWhereTheDiskFails) {
  // A regular file whose first byte cannot be read: nothing is mapped there.
  const absl::Status status = name_file("/proc/self/mem", kNever).status();
  EXPECT_THAT(std::string(status.message()), HasSubstr("cannot read /proc/self/mem"));
}

TEST(LocalFile, IsNoneWhereThereIsNone) {
  const test::TestDirectory directory;
  const std::string path = directory.file("grid");
  EXPECT_TRUE(absl::IsNotFound(name_file(path, kNever).status()));
  EXPECT_TRUE(absl::IsNotFound(name_file(directory.file("grid") + "/below", kNever).status()));
  test::write_bytes(path, "");
  EXPECT_TRUE(absl::IsInvalidArgument(name_file(path, kNever).status()));
}

}  // namespace
}  // namespace tet
