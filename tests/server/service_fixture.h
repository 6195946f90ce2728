// A real server on a free port, and solids for it to mesh.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "client/library/mesh_client.h"
#include "server/ops/logging.h"
#include "server/server.h"
#include "tests/server/plain_channel.h"
#include "tests/server/test_folder.h"
#include "tests/support/eventually.h"
#include "tests/support/vdb_fixtures.h"
#include "tetstream/v1/grids.grpc.pb.h"
#include "tetstream/v1/meshes.grpc.pb.h"

namespace tet::test {

using namespace std::chrono_literals;

class ServiceTest : public testing::Test {
 protected:
  ServiceTest() {
    start_logging("error");
    config_.listen = "127.0.0.1:0";
    config_.store = folder_.file("store");
    config_.threads = 2;
    config_.jobs = "off";
    // A test that stands still must not be taken for a client that does.
    config_.stall_seconds = 3600;
    config_.handshake_seconds = 3600;
  }

  void start() {
    auto server = Server::start(config_);
    ASSERT_TRUE(server.ok()) << server.status();
    server_ = *std::move(server);
    channel_ = plain_channel(server_->address());
    grids_ = v1::GridService::NewStub(channel_);
    meshes_ = v1::MeshService::NewStub(channel_);
    client_ = MeshClient::connect(server_->address());
  }

  void restart() {
    server_.reset();
    start();
  }

  /// See write_fixture.
  std::string solid_file(const std::string& kind, double voxel) {
    const std::string path = folder_.file(kind + std::to_string(voxel) + ".vdb");
    if (!std::filesystem::exists(path)) write_fixture(kind, voxel, path);
    return path;
  }

  /// A unit ball of voxels 1/`radius` wide, as a file.
  std::string ball_file(int radius) { return solid_file("sphere", 1.0 / radius); }

  /// Uploads a file and asks for its mesh.
  v1::MeshRequest mesh_of(const std::string& path) {
    const auto name = client_->upload_file(path, {}, never_);
    EXPECT_TRUE(name.ok()) << name.status();
    v1::MeshRequest request;
    request.set_name(name.ok() ? *name : "");
    return request;
  }

  /// The uniform mesh of a ball: about 50 radius^3 tets.
  v1::MeshRequest uniform_ball(int radius) {
    v1::MeshRequest request = mesh_of(ball_file(radius));
    request.set_levels(0);
    return request;
  }

  /// The graded mesh of both sides of a ball, up to a cube.
  v1::MeshRequest both_sides_of_ball(int radius, double half_edge) {
    v1::MeshRequest request = mesh_of(ball_file(radius));
    request.set_preset(v1::PRESET_BOTH_SIDES);
    set_point(-half_edge, *request.mutable_box()->mutable_min());
    set_point(half_edge, *request.mutable_box()->mutable_max());
    return request;
  }

  static void set_point(double everywhere, v1::Point& point) {
    point.set_x(everywhere);
    point.set_y(everywhere);
    point.set_z(everywhere);
  }

  v1::StreamMeshRequest stream_of(const v1::MeshRequest& mesh,
                                  std::int64_t start = 0,
                                  std::int64_t end = 0) {
    v1::StreamMeshRequest request;
    *request.mutable_mesh() = mesh;
    request.set_start_chunk(start);
    request.set_end_chunk(end);
    return request;
  }

  /// Whether a server comes to say that it serves: it does not while its store or a decoder
  /// has not answered for seconds, which a busy machine brings about.
  bool comes_to_serve(MeshClient& client, const std::string& service = "readiness") const {
    return eventually([&] { return client.check_health(service, never_).ok(); });
  }

  const Activity& activity() const { return server_->engine().activity; }

  /// Whether an upload to `name` comes to be under way: admitted, and its file begun.
  bool upload_begins(const std::string& name) const {
    const std::string digest = name.substr(name.find('/') + 1);
    return eventually([&] {
      return std::filesystem::exists(config_.store + "/uploads/" + digest + ".part");
    });
  }

  bool work_stops() const {
    return eventually(
        [&] { return activity().meshes == 0 && activity().chunks_in_flight == 0; });
  }

  TestFolder folder_;
  Config config_;
  Cancellation never_;
  std::unique_ptr<Server> server_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<v1::GridService::Stub> grids_;
  std::unique_ptr<v1::MeshService::Stub> meshes_;
  std::unique_ptr<MeshClient> client_;
};

}  // namespace tet::test
