// The service on a socket file.
#include <fcntl.h>
#include <fstream>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <gmock/gmock.h>
#include <grpcpp/create_channel_posix.h>
#include <gtest/gtest.h>

#include "core/base/posix/descriptor.h"
#include "core/base/posix/socket_file.h"
#include "tests/core/plan/meshing.h"
#include "tests/server/plain_channel.h"
#include "tests/server/service_fixture.h"
#include "tests/server/token_book.h"

namespace tet::test {
namespace {

using testing::HasSubstr;

class UnixSocketTest : public ServiceTest {
 protected:
  UnixSocketTest() { config_.listen_unix = socket_; }

  std::string address() const { return "unix:" + socket_; }

  /// A connection whose own end is bound to a path, as anybody may do.
  std::shared_ptr<grpc::Channel> channel_from(const std::string& own_path) const {
    const auto address_of = [](const std::string& path) {
      sockaddr_un address{};
      address.sun_family = AF_UNIX;
      path.copy(address.sun_path, sizeof address.sun_path - 1);
      return address;
    };
    const int socket = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const sockaddr_un own = address_of(own_path), there = address_of(socket_);
    EXPECT_EQ(::bind(socket, reinterpret_cast<const sockaddr*>(&own), sizeof own), 0);
    EXPECT_EQ(::connect(socket, reinterpret_cast<const sockaddr*>(&there), sizeof there), 0);
    ::fcntl(socket, F_SETFL, O_NONBLOCK);
    return grpc::CreateCustomInsecureChannelFromFd("tetstream", socket, fixed_window());
  }

  const std::string socket_ = folder_.file("socket");
};

TEST_F(UnixSocketTest, ServesTheSameMeshBesideThePort) {
  start();
  const v1::MeshRequest request = uniform_ball(12);
  const auto by_port = client_->stream_mesh(request, {}, never_);
  const auto by_file = MeshClient::connect(address())->stream_mesh(request, {}, never_);
  ASSERT_TRUE(by_port.ok()) << by_port.status();
  ASSERT_TRUE(by_file.ok()) << by_file.status();
  EXPECT_TRUE(same_bytes(by_file->mesh, by_port->mesh));
  EXPECT_EQ(server_->unix_address(), address());
  EXPECT_THAT(server_->address(), HasSubstr("127.0.0.1:"));
}

TEST_F(UnixSocketTest, ServesWithoutAPort) {
  config_.listen.clear();
  start();
  EXPECT_EQ(server_->address(), address());
  EXPECT_EQ(server_->port(), 0);
  EXPECT_TRUE(comes_to_serve(*client_));
  restart();  // the file is gone with the first server, and made by the second
  EXPECT_TRUE(comes_to_serve(*client_, ""));
  server_.reset();
  EXPECT_FALSE(std::filesystem::exists(socket_));
}

TEST_F(UnixSocketTest, TakesPathsWithAnyBytes) {
  config_.listen.clear();
  config_.listen_unix = folder_.file("a b%41#?,c").substr(0, SocketFile::kMaxPath);
  config_.listen_unix.resize(config_.listen_unix.find(','));
  start();
  EXPECT_TRUE(comes_to_serve(*client_));
}

TEST_F(UnixSocketTest, GivesTheFileItsRights) {
  for (const auto& [mode, rights] : {std::pair{"600", 0600u}, {"660", 0660u}, {"666", 0666u}}) {
    config_.listen_unix_mode = mode;
    restart();
    struct stat there {};
    ASSERT_EQ(::stat(socket_.c_str(), &there), 0);
    EXPECT_EQ(there.st_mode & 0777, rights);
  }
}

TEST_F(UnixSocketTest, WantsTokensLikeThePort) {
  TokenBook tokens(folder_);
  const std::string secret = tokens.add("mesher", "\"mesh\"", "ours");
  config_.tokens = tokens.file();
  start();
  EXPECT_EQ(MeshClient::connect(address())->capabilities(never_).status().code(),
            absl::StatusCode::kUnauthenticated);
  // Nobody can read it on its way.
  ChannelOptions options;
  options.token = secret;
  const auto client = MeshClient::connect(address(), options);
  ASSERT_TRUE(client.ok()) << client.status();
  EXPECT_TRUE((*client)->capabilities(never_).ok());
}

TEST_F(UnixSocketTest, CountsAllWhoComeThereAsOneClient) {
  config_.max_client_calls = 1;
  start();
  const auto first = channel_from(folder_.file("one")),
             second = channel_from(folder_.file("two"));
  const auto stub = v1::MeshService::NewStub(first);
  const v1::StreamMeshRequest request = stream_of(uniform_ball(24));
  grpc::ClientContext streaming;
  const auto reader = stub->StreamMesh(&streaming, request);
  v1::MeshEvent event;
  ASSERT_TRUE(reader->Read(&event));
  grpc::ClientContext asking;
  v1::Capabilities capabilities;
  const grpc::Status status = v1::MeshService::NewStub(second)->GetCapabilities(
      &asking, v1::GetCapabilitiesRequest(), &capabilities);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  streaming.TryCancel();
}

TEST_F(UnixSocketTest, EndsThoughAPeerTakesNothing) {
  config_.listen.clear();
  start();
  const v1::StreamMeshRequest request = stream_of(uniform_ball(40));
  const auto channel = channel_from(folder_.file("own"));
  const auto stub = v1::MeshService::NewStub(channel);
  grpc::ClientContext context;
  const auto reader = stub->StreamMesh(&context, request);
  v1::MeshEvent event;
  ASSERT_TRUE(reader->Read(&event));
  server_->stop(0s);
  server_.reset();
  context.TryCancel();
}

TEST_F(UnixSocketTest, SaysWhyItCannotListen) {
  std::ofstream(socket_) << "mine";
  EXPECT_EQ(Server::start(config_).status().code(), absl::StatusCode::kFailedPrecondition);
  config_.listen_unix = folder_.file(std::string(100, 'x'));
  EXPECT_EQ(Server::start(config_).status().code(), absl::StatusCode::kInvalidArgument);
  config_.listen_unix = folder_.file("another");
  start();
  Config second = config_;
  second.store = folder_.file("second");
  EXPECT_THAT(std::string(Server::start(second).status().message()), HasSubstr("somebody"));
  EXPECT_TRUE(comes_to_serve(*MeshClient::connect("unix:" + config_.listen_unix)));
}

TEST_F(UnixSocketTest, NeedsOneOfBoth) {
  config_.listen.clear();
  config_.listen_unix.clear();
  EXPECT_EQ(Server::start(config_).status().code(), absl::StatusCode::kInvalidArgument);
  config_.listen_unix = socket_;
  config_.port_file = folder_.file("port");
  EXPECT_EQ(Server::start(config_).status().code(), absl::StatusCode::kInvalidArgument);
}

TEST_F(UnixSocketTest, ClientsRefusePathsThatNoSocketCanHave) {
  const auto refused = MeshClient::connect("unix:/" + std::string(107, 'x'), ChannelOptions{});
  EXPECT_THAT(std::string(refused.status().message()), HasSubstr("108 bytes, more than 107"));
  EXPECT_EQ(MeshClient::connect("unix:", ChannelOptions{}).status().code(),
            absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace tet::test
