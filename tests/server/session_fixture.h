// Sessions with a real server, and shapes for them to follow.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "client/library/remesh_session.h"
#include "core/volume/volume.h"
#include "tests/server/service_fixture.h"

namespace tet::test {

/// A ball at -2, and a smaller one at `x`.
inline v1::Scene two_balls(double x) {
  v1::Scene scene;
  const auto add_ball = [&](const std::string& name, double radius, double at) {
    v1::SceneNode& ball = *scene.add_nodes();
    ball.set_name(name);
    ball.mutable_sphere()->set_radius(radius);
    v1::SceneNode& moved = *scene.add_nodes();
    moved.set_name(name + " moved");
    moved.mutable_transform()->set_of(name);
    for (const double along : {at, 0.0, 0.0}) {
      moved.mutable_transform()->add_translation(along);
    }
  };
  add_ball("large", 1, -2);
  add_ball("small", 0.3, x);
  v1::SceneNode& both = *scene.add_nodes();
  for (const char* of : {"large moved", "small moved"}) both.mutable_union_()->add_of(of);
  return scene;
}

inline v1::MeshRequest request_of(const v1::Scene& scene) {
  v1::MeshRequest request;
  *request.mutable_scene() = scene;
  request.set_spacing(0.05);
  return request;
}

/// A leaf that moves the surface of a level set outward.
inline v1::LeafUpdate inflated(const Volume& volume, std::size_t brick) {
  v1::LeafUpdate leaf;
  leaf.set_x(8 * volume.bricks[brick].x);
  leaf.set_y(8 * volume.bricks[brick].y);
  leaf.set_z(8 * volume.bricks[brick].z);
  std::vector<float> values(
      volume.values.begin() + static_cast<std::ptrdiff_t>(brick * 512),
      volume.values.begin() + static_cast<std::ptrdiff_t>(brick * 512 + 512));
  for (float& value : values) value -= 0.3F * volume.background;
  leaf.set_values(values.data(), values.size() * sizeof(float));
  return leaf;
}

class RemeshSessionTest : public ServiceTest {
 protected:
  using Session = std::unique_ptr<RemeshSession>;

  Session begin(const v1::MeshRequest& request) {
    auto session = client_->begin_session(request, never_);
    EXPECT_TRUE(session.ok()) << session.status();
    return session.ok() ? *std::move(session) : nullptr;
  }

  /// What a client is told that says this, and knows refusals.
  std::vector<v1::MeshEvent> events_after(std::vector<v1::RemeshRequest> messages) {
    messages.front().set_tell_refusals(true);
    std::vector<v1::MeshEvent> events;
    const grpc::Status status =
        exchange(messages, [&](const v1::MeshEvent& event) { events.push_back(event); });
    EXPECT_TRUE(status.ok()) << status.error_message();
    return events;
  }

  /// How a session ends in which a client says this.
  grpc::Status answer_to(const std::vector<v1::RemeshRequest>& messages) {
    return exchange(messages, [](const v1::MeshEvent&) {});
  }

 private:
  /// Reads while it writes: a server that cannot send reads nothing more.
  grpc::Status exchange(const std::vector<v1::RemeshRequest>& messages,
                        const std::function<void(const v1::MeshEvent&)>& take) {
    grpc::ClientContext context;
    const auto stream = meshes_->RemeshSession(&context);
    std::jthread writer([&] {
      for (const v1::RemeshRequest& message : messages) stream->Write(message);
      stream->WritesDone();
    });
    for (v1::MeshEvent event; stream->Read(&event);) take(event);
    writer.join();
    return stream->Finish();
  }
};

}  // namespace tet::test
