// A mesh that is being made for as long as a test needs it to be.
#pragma once

#include <functional>
#include <future>

#include <grpcpp/client_context.h>

#include "tetstream/v1/meshes.grpc.pb.h"

namespace tet::test {

/// An estimate that takes minutes to count and little memory, and is cancelled before: 2,048
/// ellipsoids, all of which are looked at for each brick.
class HeldPlan {
 public:
  explicit HeldPlan(::tetstream::v1::MeshService::Stub& meshes) {
    auto& scene = *request_.mutable_mesh()->mutable_scene();
    auto& grain = *scene.add_nodes();
    grain.set_name("grain");
    for (const double semi_axis : {1.0, 0.7, 0.5}) {
      grain.mutable_ellipsoid()->add_semi_axes(semi_axis);
    }
    auto& grains = *scene.add_nodes()->mutable_repeat();
    grains.set_of("grain");
    for (const int count : {16, 16, 8}) grains.add_count(count);
    for (const double step : {1.9, 1.3, 0.9}) grains.add_step(step);
    request_.mutable_mesh()->set_spacing(0.1);
    meshes.async()->EstimateMesh(
        &context_, &request_, &header_,
        [this](const grpc::Status& status) { end_.set_value(status.error_code()); });
  }
  ~HeldPlan() { let_go(); }
  HeldPlan(const HeldPlan&) = delete;
  HeldPlan& operator=(const HeldPlan&) = delete;

  /// Returns once the server has let go of it.
  grpc::StatusCode let_go() {
    context_.TryCancel();
    return ended_.get();
  }

 private:
  grpc::ClientContext context_;
  ::tetstream::v1::EstimateMeshRequest request_;
  ::tetstream::v1::MeshHeader header_;
  std::promise<grpc::StatusCode> end_;
  std::shared_future<grpc::StatusCode> ended_ = end_.get_future().share();
};

}  // namespace tet::test
