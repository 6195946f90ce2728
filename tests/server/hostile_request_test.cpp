// Requests that claim more than there is: each is refused at once, before memory is taken for
// it.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/service_fixture.h"

namespace tet::test {
namespace {

struct Claim {
  const char* what;
  std::function<void(v1::MeshRequest&)> make;
};

class HostileRequestTest : public ServiceTest {
 protected:
  HostileRequestTest() { start(); }

  grpc::Status estimate(const v1::MeshRequest& mesh) {
    v1::EstimateMeshRequest request;
    *request.mutable_mesh() = mesh;
    v1::MeshHeader header;
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kGenerousEnd);
    return meshes_->EstimateMesh(&context, request, &header);
  }

  static void both_sides(v1::MeshRequest& mesh, double half_edge) {
    mesh.set_preset(v1::PRESET_BOTH_SIDES);
    set_point(-half_edge, *mesh.mutable_box()->mutable_min());
    set_point(half_edge, *mesh.mutable_box()->mutable_max());
  }
};

TEST_F(HostileRequestTest, ClaimsAreRefusedWithTheirNumbers) {
  const v1::MeshRequest ball = mesh_of(ball_file(8));
  const std::vector<Claim> claims = {
      {"spacing 1e-6", [](auto& mesh) { mesh.set_spacing(1e-6); }},
      {"spacing 1e-300", [](auto& mesh) { mesh.set_spacing(1e-300); }},
      {"the least spacing", [](auto& mesh) { mesh.set_spacing(5e-324); }},
      {"uniform, spacing 1e-4",
       [](auto& mesh) {
         mesh.set_spacing(1e-4);
         mesh.set_levels(0);
       }},
      {"a box of 1e300", [](auto& mesh) { both_sides(mesh, 1e300); }},
      {"a box of the largest number", [](auto& mesh) { both_sides(mesh, 1.7e308); }},
      {"a uniform box",
       [](auto& mesh) {
         both_sides(mesh, 1e4);
         mesh.set_levels(0);
       }},
      {"a box at spacing 1e-9",
       [](auto& mesh) {
         both_sides(mesh, 2);
         mesh.set_spacing(1e-9);
       }},
      {"one level in a large box",
       [](auto& mesh) {
         both_sides(mesh, 1e5);
         mesh.set_levels(1);
       }},
      {"an iso value beyond all", [](auto& mesh) { mesh.set_iso(3e38); }},
      {"levels beyond all", [](auto& mesh) { mesh.set_levels(2'000'000'000); }},
  };
  for (const Claim& claim : claims) {
    v1::MeshRequest mesh = ball;
    claim.make(mesh);
    const grpc::Status status = estimate(mesh);
    EXPECT_THAT(status.error_code(), testing::AnyOf(grpc::StatusCode::RESOURCE_EXHAUSTED,
                                                    grpc::StatusCode::INVALID_ARGUMENT,
                                                    grpc::StatusCode::FAILED_PRECONDITION))
        << claim.what << ": " << status.error_message();
  }
}

TEST_F(HostileRequestTest, ASpacingFarBeyondTheVoxelsIsRefused) {
  v1::MeshRequest ball = mesh_of(ball_file(8));
  for (const double spacing : {1e3, 1e30, 1e300}) {
    ball.set_spacing(spacing);
    EXPECT_EQ(estimate(ball).error_code(), grpc::StatusCode::INVALID_ARGUMENT) << spacing;
  }
}

}  // namespace
}  // namespace tet::test
