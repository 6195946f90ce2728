// Sessions: a mesh that follows its shape, frame by frame, over a real connection.
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/plan/make/mesher.h"
#include "core/vdb/openvdb/load.h"
#include "core/volume/replace_leaves.h"
#include "tests/core/plan/meshing.h"
#include "tests/server/passing_time.h"
#include "tests/server/reason_of.h"
#include "tests/server/session_fixture.h"

namespace tet::test {
namespace {

using testing::HasSubstr;

v1::Point point(double x, double y, double z) {
  v1::Point made;
  made.set_x(x);
  made.set_y(y);
  made.set_z(z);
  return made;
}

/// The volume that all tets have together.
double volume_of(const TetMesh& mesh) {
  double volume = 0;
  for (std::uint64_t i = 0; i < mesh.header.tet_count; ++i) {
    const auto [a, b, c, d] = mesh.view().stored_places(i);
    const double x = (c.y - a.y) * (d.z - a.z) - (c.z - a.z) * (d.y - a.y);
    const double y = (c.z - a.z) * (d.x - a.x) - (c.x - a.x) * (d.z - a.z);
    const double z = (c.x - a.x) * (d.y - a.y) - (c.y - a.y) * (d.x - a.x);
    volume += ((b.x - a.x) * x + (b.y - a.y) * y + (b.z - a.z) * z) / 6;
  }
  return volume;
}

TEST_F(RemeshSessionTest, BringsTheMeshOfEachSceneAndOnlyWhatChanged) {
  start();
  const Session session = begin(request_of(two_balls(0)));
  ASSERT_TRUE(session);
  for (const double x : {0.0, 0.02, 0.2, 1.5}) {
    ASSERT_EQ(session->update(two_balls(x)), absl::OkStatus());
    const StreamedMesh& mesh = session->mesh();
    EXPECT_LT(session->tets_sent(), mesh.mesh.header.tet_count / 4) << x;
    const auto whole = client_->stream_mesh(mesh.canonical_request, {}, never_);
    ASSERT_TRUE(whole.ok()) << whole.status();
    EXPECT_EQ(whole->mesh_id, mesh.mesh_id);
    EXPECT_TRUE(same_bytes(whole->mesh, mesh.mesh)) << x;
  }
  EXPECT_EQ(session->end(), absl::OkStatus());
  EXPECT_TRUE(work_stops());
}

TEST_F(RemeshSessionTest, BringsWholeMeshesOfWhatABoxCuts) {
  start();
  v1::MeshRequest request = request_of(two_balls(0));
  *request.mutable_box()->mutable_min() = point(-2.4, -0.4, -0.4);
  *request.mutable_box()->mutable_max() = point(2, 0.4, 0.4);
  const Session session = begin(request);
  ASSERT_TRUE(session);
  for (const double x : {0.0, 0.2}) {
    ASSERT_EQ(session->update(two_balls(x)), absl::OkStatus());
    const StreamedMesh& mesh = session->mesh();
    ASSERT_FALSE(mesh.mesh.header.fields.empty());
    EXPECT_EQ(mesh.mesh.header.fields.back().name, kCutFaceArray);
    const auto whole = client_->stream_mesh(mesh.canonical_request, {}, never_);
    ASSERT_TRUE(whole.ok()) << whole.status();
    EXPECT_TRUE(same_bytes(whole->mesh, mesh.mesh)) << x;
  }
}

TEST_F(RemeshSessionTest, BringsTheMeshOfAGridWhoseLeavesChange) {
  start();
  const std::string path = solid_file("torus", 0.05);
  Volume volume = load_volume(path, "").value();
  const Session session = begin(mesh_of(path));
  ASSERT_TRUE(session);
  const std::uint64_t tets = session->mesh().mesh.header.tet_count;
  for (const std::size_t brick : {volume.bricks.size() / 2, volume.bricks.size() / 3}) {
    const v1::LeafUpdate leaf = inflated(volume, brick);
    ASSERT_EQ(session->update(std::vector{leaf}), absl::OkStatus());
    EXPECT_LT(session->tets_sent(), tets / 2);
    std::vector<float> values(kBrickCells);
    std::memcpy(values.data(), leaf.values().data(), leaf.values().size());
    volume = replace_leaves(volume, {{volume.bricks[brick], values}}).value();
    MeshRequest request;
    request.levels = default_levels(Sizing());
    request.origin = session->mesh().mesh.header.origin;
    TaskPool pool(2);
    const auto here = mesh_volume(
        pool, {.shape = std::make_shared<const Volume>(volume), .request = request});
    ASSERT_TRUE(here.ok()) << here.status();
    EXPECT_TRUE(same_bytes(here->mesh, session->mesh().mesh));
  }
  EXPECT_EQ(session->end(), absl::OkStatus());
  EXPECT_TRUE(eventually([&] { return activity().changed_grid_bytes == 0; }));
}

/// Faces with a label of this name.
std::uint64_t faces_named(const TetMesh& mesh, const std::string& name) {
  std::uint64_t faces = 0;
  for (std::uint64_t i = 0; i < mesh.header.face_count; ++i) {
    faces += mesh.header.face_labels.at(mesh.face_label(i)).name == name ? 1 : 0;
  }
  return faces;
}

TEST_F(RemeshSessionTest, NamesTheFacesOfEachFrameByWhereTheyLieThen) {
  start();
  v1::MeshRequest request = request_of(two_balls(0));
  v1::FaceRegion& small = *request.add_face_regions();
  small.set_name("small");
  small.set_node("small");
  v1::FaceRegion& right = *request.add_face_regions();
  right.set_name("right");
  for (const double along : {-1.0, 0.0, 0.0}) {
    right.mutable_half_space()->mutable_normal()->Add(along);
  }
  right.mutable_half_space()->set_offset(2);  // x at least -2
  v1::FaceRegion& patches = *request.add_face_regions();
  patches.set_name("left");
  patches.mutable_creases()->set_angle_deg(60);
  const Session session = begin(request);
  ASSERT_TRUE(session);
  const std::uint64_t of_small = faces_named(session->mesh().mesh, "small");
  EXPECT_GT(of_small, 100U);
  for (const double x : {0.2, -1.1}) {
    ASSERT_EQ(session->update(two_balls(x)), absl::OkStatus());
    const StreamedMesh& mesh = session->mesh();
    EXPECT_EQ(session->tets_sent(), mesh.mesh.header.tet_count) << "it is sent whole";
    const auto whole = client_->stream_mesh(mesh.canonical_request, {}, never_);
    ASSERT_TRUE(whole.ok()) << whole.status();
    EXPECT_EQ(whole->mesh_id, mesh.mesh_id);
    EXPECT_EQ(whole->mesh.header.face_labels, mesh.mesh.header.face_labels);
    EXPECT_TRUE(same_bytes(whole->mesh, mesh.mesh)) << x;
    EXPECT_GT(faces_named(mesh.mesh, "right"), 100U);
    EXPECT_EQ(faces_named(mesh.mesh, "surface"), 0U);
    EXPECT_GT(faces_named(mesh.mesh, "left.1"), 100U);
  }
  EXPECT_LT(faces_named(session->mesh().mesh, "small"), of_small * 3 / 4)
      << "the large ball has taken the rest in";
  EXPECT_EQ(session->end(), absl::OkStatus());
}

TEST_F(RemeshSessionTest, NamesTheFacesOfAGridWhoseLeavesChange) {
  start();
  const std::string path = solid_file("torus", 0.05);
  const Volume volume = load_volume(path, "").value();
  v1::MeshRequest request = mesh_of(path);
  v1::FaceRegion& top = *request.add_face_regions();
  top.set_name("top");
  for (const double along : {0.0, 0.0, 1.0}) {
    top.mutable_facing()->mutable_direction()->Add(along);
  }
  top.mutable_facing()->set_angle_deg(40);
  v1::FaceRegion& rest = *request.add_face_regions();
  rest.set_name("rest");
  rest.mutable_creases()->set_angle_deg(70);
  const Session session = begin(request);
  ASSERT_TRUE(session);
  const std::size_t brick = volume.bricks.size() / 2;
  const v1::LeafUpdate leaf = inflated(volume, brick);
  ASSERT_EQ(session->update(std::vector{leaf}), absl::OkStatus());
  std::vector<float> values(kBrickCells);
  std::memcpy(values.data(), leaf.values().data(), leaf.values().size());
  const Volume moved = replace_leaves(volume, {{volume.bricks[brick], values}}).value();
  const TetMesh& mesh = session->mesh().mesh;
  MeshRequest here;
  here.levels = default_levels(Sizing());
  here.origin = mesh.header.origin;
  here.faces = true;
  here.face_regions = mesh.header.face_regions;
  ASSERT_EQ(here.face_regions.size(), 2U);
  TaskPool pool(2);
  const auto made =
      mesh_volume(pool, {.shape = std::make_shared<const Volume>(moved), .request = here});
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_EQ(made->mesh.header.face_labels, mesh.header.face_labels);
  EXPECT_TRUE(same_bytes(made->mesh, mesh));
  EXPECT_GT(faces_named(mesh, "top"), 100U);
  EXPECT_GT(faces_named(mesh, "rest.1"), 100U);
}

TEST_F(RemeshSessionTest, KeepsTheSideOfItsFirstRequestForEveryFrame) {
  start();
  const std::string path = solid_file("inverted", 0.1);
  const Volume volume = load_volume(path, "").value();
  v1::MeshRequest request = mesh_of(path);
  EXPECT_FALSE(client_->begin_session(request, never_).ok()) << "its side has to be said";
  request.set_inside(v1::INSIDE_ABOVE);
  const Session session = begin(request);
  ASSERT_TRUE(session);
  const double before = volume_of(session->mesh().mesh);
  EXPECT_NEAR(before, 4.19, 0.1) << "the ball, and not what is around it";
  // The ball is where values are positive, so that it does not grow.
  ASSERT_EQ(session->update(std::vector{inflated(volume, volume.bricks.size() / 2)}),
            absl::OkStatus());
  EXPECT_LE(volume_of(session->mesh().mesh), before);
  EXPECT_GT(volume_of(session->mesh().mesh), 3.5);
}

TEST_F(RemeshSessionTest, AnswersFramesThatAreSentAheadInTheirOrder) {
  start();
  std::vector<v1::RemeshRequest> messages(4);
  *messages[0].mutable_start() = request_of(two_balls(0));
  for (std::size_t i = 1; i < messages.size(); ++i) {
    *messages[i].mutable_frame()->mutable_scene() = two_balls(0.1 * static_cast<double>(i));
  }
  grpc::ClientContext context;
  const auto stream = meshes_->RemeshSession(&context);
  for (const v1::RemeshRequest& message : messages) ASSERT_TRUE(stream->Write(message));
  stream->WritesDone();
  std::vector<v1::MeshHeader> headers;
  std::size_t trailers = 0;
  for (v1::MeshEvent event; stream->Read(&event);) {
    if (event.has_header()) headers.push_back(event.header());
    trailers += event.has_trailer() ? 1 : 0;
  }
  const grpc::Status status = stream->Finish();
  EXPECT_TRUE(status.ok()) << status.error_message();
  ASSERT_EQ(headers.size(), messages.size());
  EXPECT_EQ(trailers, messages.size());
  for (std::size_t i = 1; i < messages.size(); ++i) {
    EXPECT_TRUE(headers[i].has_kept());
    EXPECT_EQ(headers[i].canonical_request().scene().SerializeAsString(),
              messages[i].frame().scene().SerializeAsString());
  }
}

TEST_F(RemeshSessionTest, TakesNoTurnFromOthersWhileItWaits) {
  config_.max_streams = 1;
  start();
  const Session session = begin(request_of(two_balls(0)));
  ASSERT_TRUE(session);
  EXPECT_TRUE(client_->stream_mesh(uniform_ball(8), {}, never_).ok());
  EXPECT_EQ(session->update(two_balls(0.1)), absl::OkStatus());
}

TEST_F(RemeshSessionTest, EndsASessionWhoseClientSendsNothing) {
  config_.stall_seconds = 2 * config_.session_idle_seconds;
  start();
  const Session session = begin(request_of(two_balls(0)));
  ASSERT_TRUE(session);
  const PassingTime passing(*server_, config_.session_idle_seconds);
  ASSERT_TRUE(eventually([&] { return server_->running_calls() == 0; }));
  const absl::Status late = session->update(two_balls(0.1));
  EXPECT_EQ(late.code(), absl::StatusCode::kAborted) << late;
  EXPECT_THAT(std::string(late.message()), HasSubstr("sent no frame for"));
  EXPECT_EQ(session->update(two_balls(0.1)).code(), absl::StatusCode::kFailedPrecondition);
}

TEST_F(RemeshSessionTest, EndsWithTheServerAndWithItsClient) {
  start();
  Session session = begin(request_of(two_balls(0)));
  ASSERT_TRUE(session);
  const Session gone = begin(request_of(two_balls(1)));
  session.reset();
  EXPECT_TRUE(eventually([&] { return server_->running_calls() == 1; }));
  server_->stop(0s);
  EXPECT_EQ(gone->update(two_balls(0.1)).code(), absl::StatusCode::kUnavailable);
}

TEST_F(RemeshSessionTest, RefusesAFrameWhoseGridHasNoRoomBeforeItIsMade) {
  config_.resident_bytes = 64 << 20;
  start();
  v1::RemeshRequest begin, frame;
  *begin.mutable_start() = mesh_of(ball_file(12));
  for (std::int32_t i = 1; i <= 2000; ++i) {  // each of which makes a region
    v1::LeafUpdate& leaf = *frame.mutable_frame()->add_leaves();
    leaf.set_x(128 * i);
    leaf.set_values(std::string(4, '\0'));
  }
  const grpc::Status status = answer_to({begin, frame});
  EXPECT_EQ(reason_of(status), "tetstream/LIMIT_EXCEEDED") << status.error_message();
  EXPECT_THAT(status.error_message(), HasSubstr("sessions' changed grids"));
  EXPECT_TRUE(eventually([&] { return activity().changed_grid_bytes == 0; }));
}

TEST_F(RemeshSessionTest, RefusesWhatIsNoSessionAndSaysWhy) {
  start();
  v1::RemeshRequest scene, grid, frame, leaves, moved, odd, torn, nothing, part;
  *scene.mutable_start() = request_of(two_balls(0));
  *grid.mutable_start() = mesh_of(ball_file(12));
  frame.mutable_frame();
  *moved.mutable_frame()->mutable_scene() = two_balls(1);
  leaves.mutable_frame()->add_leaves()->set_values(std::string(4, '\0'));
  odd = torn = leaves;
  odd.mutable_frame()->mutable_leaves(0)->set_y(3);
  torn.mutable_frame()->mutable_leaves(0)->set_values("abc");
  *part.mutable_part() = leaves.frame();
  struct Case {
    std::vector<v1::RemeshRequest> messages;
    std::string reason, message;
  };
  const Case cases[] = {
      {{}, "MESSAGE_ORDER", "it ended before `start`"},
      {{frame}, "MESSAGE_ORDER", "a frame before `start`"},
      {{part}, "MESSAGE_ORDER", "a frame before `start`"},
      {{grid, part}, "MESSAGE_ORDER", "it ended before the `frame`"},
      {{scene, scene}, "MESSAGE_ORDER", "a second `start`"},
      {{scene, nothing}, "MESSAGE_ORDER", "a message with neither `start` nor `frame`"},
      {{scene, leaves}, "INVALID_FIELD", "leaves are set, but the session began with"},
      {{grid, moved}, "INVALID_FIELD", "scene is set, but the session began with"},
      {{grid, odd}, "INVALID_FIELD", "y 3 is not a multiple of 8"},
      {{grid, torn}, "INVALID_FIELD", "values has 3 bytes"},
  };
  for (const Case& c : cases) {
    const grpc::Status status = answer_to(c.messages);
    EXPECT_EQ(reason_of(status), "tetstream/" + c.reason) << status.error_message();
    EXPECT_THAT(status.error_message(), HasSubstr(c.message));
  }
}

}  // namespace
}  // namespace tet::test
