// The worst requests known, against what a server may have: its resident memory at most.
#include <fstream>
#include <list>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/server/job_server.h"
#include "tests/server/token_book.h"

namespace tet::test {
namespace {

constexpr char kScopes[] = "\"grids.read\", \"grids.write\", \"mesh\"";
constexpr std::uint64_t kMebibyte = std::uint64_t{1} << 20;

class MemoryUseTest : public testing::Test {
 protected:
  MemoryUseTest() {
    for (const char* name : {"a", "b", "c"}) tokens_.add(name, kScopes, "shared");
    server_.start({"--memory", "1GiB", "--jobs", "off", "--tokens", tokens_.file()});
    server_.use_token("secret-of-a");
  }

  /// Resident at most so far.
  std::uint64_t peak_bytes() const {
    std::ifstream status("/proc/" + std::to_string(server_.process->pid()) + "/status");
    std::uint64_t kibibytes = 0;
    for (std::string word; status >> word;) {
      if (word == "VmHWM:") status >> kibibytes;
    }
    return kibibytes << 10;
  }

  /// Each client asks for all of them, one after the other, and beside the others.
  void estimate_all(const std::vector<v1::MeshRequest>& meshes) {
    std::list<std::jthread> clients;
    for (const std::string name : {"a", "b", "c"}) {
      clients.emplace_back([this, &meshes, name] {
        for (const v1::MeshRequest& mesh : meshes) {
          grpc::ClientContext context;
          context.AddMetadata("authorization", "Bearer secret-of-" + name);
          v1::EstimateMeshRequest request;
          *request.mutable_mesh() = mesh;
          v1::MeshHeader header;
          server_.meshes->EstimateMesh(&context, request, &header);
        }
      });
    }
  }

  void expect_within_limit() {
    const std::uint64_t peak = peak_bytes();
    std::cerr << "peak " << peak / kMebibyte << " MiB\n";
    EXPECT_GT(peak, 0U) << "the server is gone";
    EXPECT_LT(peak, 1024 * kMebibyte);
  }

  JobServer server_{TETSTREAMD_PATH};
  TokenBook tokens_{server_.folder};
};

v1::MeshRequest sphere(double spacing) {
  v1::MeshRequest request;
  request.mutable_scene()->add_nodes()->mutable_sphere()->set_radius(1);
  request.set_spacing(spacing);
  return request;
}

TEST_F(MemoryUseTest, OfPlansStaysWithinIt) {
  v1::MeshRequest signs = server_.slow_to_count().mesh();
  v1::MeshRequest uniform = sphere(1.0 / 300);
  uniform.set_levels(0);
  v1::MeshRequest improved = sphere(1.0 / 100);
  improved.set_improve(true);
  estimate_all({sphere(1.0 / 1700), signs, uniform, improved, sphere(1.0 / 200)});
  expect_within_limit();
}

TEST_F(MemoryUseTest, OfASessionStaysWithinIt) {
  grpc::ClientContext context;
  context.AddMetadata("authorization", "Bearer secret-of-a");
  v1::RemeshRequest begin, frame;
  *begin.mutable_start() = server_.ball(8).mesh();
  for (std::int32_t i = 0; i < 100'000; ++i) {  // each of which makes a region of 32 KiB
    v1::LeafUpdate& leaf = *frame.mutable_frame()->add_leaves();
    leaf.set_x(128 * (i % 300 + 2));
    leaf.set_y(128 * (i / 300));
    leaf.set_values(std::string(4, '\0'));
  }
  const auto stream = server_.meshes->RemeshSession(&context);
  stream->Write(begin);
  stream->Write(frame);
  stream->WritesDone();
  for (v1::MeshEvent event; stream->Read(&event);) {
  }
  EXPECT_EQ(stream->Finish().error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  expect_within_limit();
}

}  // namespace
}  // namespace tet::test
