#include "core/base/posix/socket_file.h"

#include <filesystem>
#include <fstream>
#include <optional>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/test_directory.h"

namespace tet {
namespace {

using testing::HasSubstr;

class SocketFileTest : public testing::Test {
 protected:
  static sockaddr_un address_of(const std::string& path) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    return address;
  }

  static Descriptor listener_at(const std::string& path) {
    Descriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
    const sockaddr_un address = address_of(path);
    EXPECT_EQ(
        ::bind(socket.number(), reinterpret_cast<const sockaddr*>(&address), sizeof address),
        0);
    EXPECT_EQ(::listen(socket.number(), 4), 0);
    return socket;
  }

  static bool connects(const std::string& path) {
    const Descriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
    const sockaddr_un address = address_of(path);
    return ::connect(socket.number(), reinterpret_cast<const sockaddr*>(&address),
                     sizeof address) == 0;
  }

  /// Listens at `path_`, and says how that went.
  absl::Status listen(std::optional<SocketFile>& file, mode_t rights = 0600) {
    auto prepared = SocketFile::prepare(path_);
    if (!prepared.ok()) return prepared.status();
    file.emplace(*std::move(prepared));
    listener_ = listener_at(file->bind_path());
    return file->publish(rights);
  }

  std::size_t names_in_folder() const {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(folder_.file("")),
                      std::filesystem::directory_iterator()));
  }

  test::TestDirectory folder_;
  const std::string path_ = folder_.file("socket");
  Descriptor listener_;
};

TEST_F(SocketFileTest, HasTheRightsItIsGivenAndGoesWithItsOwner) {
  for (const mode_t rights : {mode_t{0600}, mode_t{0660}, mode_t{0666}}) {
    std::optional<SocketFile> file;
    const mode_t before = ::umask(0177);
    ASSERT_EQ(listen(file, rights), absl::OkStatus());
    ::umask(before);
    struct stat there {};
    ASSERT_EQ(::stat(path_.c_str(), &there), 0);
    EXPECT_EQ(there.st_mode & 0777, rights);
    EXPECT_TRUE(connects(path_));
    EXPECT_EQ(names_in_folder(), 1u);
    file.reset();
    EXPECT_EQ(names_in_folder(), 0u);
  }
}

TEST_F(SocketFileTest, IsNotReachedBeforeItHasItsRights) {
  auto file = SocketFile::prepare(path_);
  ASSERT_TRUE(file.ok()) << file.status();
  listener_ = listener_at(file->bind_path());
  EXPECT_FALSE(std::filesystem::exists(path_));
  for (const auto& entry : std::filesystem::directory_iterator(folder_.file(""))) {
    EXPECT_EQ(entry.status().permissions(), std::filesystem::perms::owner_all);
  }
}

TEST_F(SocketFileTest, ReplacesAFileThatNobodyListensOn) {
  listener_at(path_).close();
  ASSERT_TRUE(std::filesystem::exists(path_));
  std::optional<SocketFile> file;
  EXPECT_EQ(listen(file), absl::OkStatus());
  EXPECT_TRUE(connects(path_));
}

TEST_F(SocketFileTest, TellsOfALongNameWhetherAnybodyListensThere) {
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder_.file(""));
  const std::string name(100, 'n');
  {
    const Descriptor other = listener_at(name);
    EXPECT_TRUE(absl::IsUnavailable(SocketFile::prepare(name).status()));
  }
  const absl::Status abandoned = SocketFile::prepare(name).status();
  EXPECT_EQ(abandoned, absl::OkStatus());
  std::filesystem::current_path(before);
}

TEST_F(SocketFileTest, LeavesASocketThatSomebodyListensOn) {
  for (const int type : {SOCK_STREAM, SOCK_SEQPACKET}) {
    std::filesystem::remove(path_);
    const Descriptor other(::socket(AF_UNIX, type | SOCK_CLOEXEC, 0));
    const sockaddr_un address = address_of(path_);
    ASSERT_EQ(
        ::bind(other.number(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    ASSERT_EQ(::listen(other.number(), 4), 0);
    const auto refused = SocketFile::prepare(path_);
    EXPECT_EQ(refused.status().code(), absl::StatusCode::kUnavailable);
    EXPECT_THAT(std::string(refused.status().message()), HasSubstr("listens on " + path_));
    EXPECT_EQ(names_in_folder(), 1u);
  }
}

TEST_F(SocketFileTest, LeavesWhatIsNoSocketAndLinksToOne) {
  std::ofstream(path_) << "mine";
  const auto file = SocketFile::prepare(path_);
  EXPECT_EQ(file.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(std::filesystem::file_size(path_), 4u);

  std::filesystem::remove(path_);
  listener_at(folder_.file("stale")).close();
  std::filesystem::create_symlink(folder_.file("stale"), path_);
  EXPECT_EQ(SocketFile::prepare(path_).status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_TRUE(std::filesystem::exists(folder_.file("stale")));
}

TEST_F(SocketFileTest, LeavesAnothersFileThatTookItsPlace) {
  std::optional<SocketFile> file;
  ASSERT_EQ(listen(file), absl::OkStatus());
  std::filesystem::remove(path_);
  const Descriptor other = listener_at(path_);
  file.reset();
  EXPECT_TRUE(connects(path_));
}

TEST_F(SocketFileTest, OfTwoWhoTakeThePathAtOnceOneGetsIt) {
  auto first = SocketFile::prepare(path_), second = SocketFile::prepare(path_);
  ASSERT_TRUE(first.ok() && second.ok());
  const Descriptor one = listener_at(first->bind_path());
  const Descriptor two = listener_at(second->bind_path());
  EXPECT_EQ(first->publish(0600), absl::OkStatus());
  EXPECT_EQ(second->publish(0600).code(), absl::StatusCode::kUnavailable);
  EXPECT_TRUE(connects(path_));
}

TEST_F(SocketFileTest, RefusesAPathThatIsTooLongOrHasNoName) {
  const std::string longest =
      folder_.file(std::string(SocketFile::kMaxPath - folder_.file("").size(), 'x'));
  EXPECT_TRUE(SocketFile::prepare(longest).ok());
  const auto refused = SocketFile::prepare(longest + "x");
  EXPECT_EQ(refused.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(refused.status().message()), HasSubstr("101 bytes, more than 100"));
  for (const std::string& path : {std::string(), folder_.file("")}) {
    EXPECT_EQ(SocketFile::prepare(path).status().code(), absl::StatusCode::kInvalidArgument);
  }
  EXPECT_EQ(SocketFile::prepare(folder_.file("none/socket")).status().code(),
            absl::StatusCode::kNotFound);
}

}  // namespace
}  // namespace tet
