// Frames of sessions: in several messages, and such as cannot be meshed.
#include <array>
#include <cstddef>
#include <cstdint>
#include <malloc.h>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/library/error_details.h"
#include "core/vdb/openvdb/load.h"
#include "tests/core/plan/meshing.h"
#include "tests/server/passing_time.h"
#include "tests/server/reason_of.h"
#include "tests/server/session_fixture.h"

namespace tet::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

using SessionFramesTest = RemeshSessionTest;

TEST_F(SessionFramesTest, RefusesAFrameWithABadLeafAndGoesOn) {
  start();
  const std::string path = solid_file("torus", 0.02);
  const Volume volume = load_volume(path, "").value();
  ASSERT_GT(volume.bricks.size(), 1000U) << "or they go in one message";
  std::vector<v1::LeafUpdate> leaves;
  for (std::size_t i = 0; i < volume.bricks.size(); ++i) leaves.push_back(inflated(volume, i));
  std::vector<v1::LeafUpdate> bad = leaves;
  bad[700].set_y(bad[700].y() + 3);
  v1::MeshRequest request = mesh_of(path);
  request.set_spacing(0.08);
  const Session session = begin(request), undisturbed = begin(request);
  ASSERT_TRUE(session && undisturbed);
  const TetMesh& mesh = session->mesh().mesh;
  const absl::Status refused = session->update(bad);
  EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument) << refused;
  EXPECT_THAT(std::string(refused.message()), HasSubstr("is not a multiple of 8"));
  EXPECT_EQ(field_of_failure(refused), "frame.leaves[700].y");
  EXPECT_EQ(reason_of_failure(refused), "INVALID_FIELD");
  EXPECT_FALSE(session->is_over());
  EXPECT_TRUE(same_bytes(mesh, undisturbed->mesh().mesh));
  EXPECT_TRUE(eventually([&] { return activity().changed_grid_bytes == 0; }));
  // Had the refused frame left anything behind, this one would make another mesh of it.
  ASSERT_EQ(session->update(leaves), absl::OkStatus());
  ASSERT_EQ(undisturbed->update(leaves), absl::OkStatus());
  EXPECT_EQ(session->mesh().mesh_id, undisturbed->mesh().mesh_id);
  EXPECT_TRUE(same_bytes(mesh, undisturbed->mesh().mesh));
  EXPECT_EQ(session->end(), absl::OkStatus());
}

TEST_F(SessionFramesTest, MakesTheSameOfAFrameHoweverItIsDivided) {
  start();
  const std::string path = solid_file("torus", 0.05);
  const Volume volume = load_volume(path, "").value();
  v1::RemeshRequest begin, whole, first, second, rest;
  *begin.mutable_start() = mesh_of(path);
  for (std::size_t i = 0; i < 40; ++i) {
    const v1::LeafUpdate leaf = inflated(volume, i);
    *whole.mutable_frame()->add_leaves() = leaf;
    *(i < 10 ? first : second).mutable_part()->add_leaves() = leaf;
  }
  rest.mutable_frame();
  // How often progress is told depends on how long it takes.
  const auto meshes_after = [&](std::vector<v1::RemeshRequest> messages) {
    std::vector<std::string> said;
    for (const v1::MeshEvent& event : events_after(std::move(messages))) {
      if (!event.has_progress()) said.push_back(event.SerializeAsString());
    }
    return said;
  };
  const auto at_once = meshes_after({begin, whole});
  EXPECT_GT(at_once.size(), 5U);
  EXPECT_TRUE(at_once == meshes_after({begin, first, second, rest}));
}

TEST_F(SessionFramesTest, AnswersFramesAfterOneThatCannotBeMeshed) {
  start();
  std::vector<v1::RemeshRequest> messages(6);
  *messages[0].mutable_start() = request_of(two_balls(0));
  *messages[1].mutable_frame()->mutable_scene() = two_balls(0.1);
  *messages[2].mutable_frame()->mutable_scene() = two_balls(0.2);
  messages[2].mutable_frame()->mutable_scene()->mutable_nodes(0)->mutable_sphere()->set_radius(
      -1);
  messages[3].mutable_part()->add_leaves()->set_values(std::string(4, '\0'));
  messages[4].mutable_frame();
  *messages[5].mutable_frame()->mutable_scene() = two_balls(0.3);
  std::vector<std::string> answers;
  for (const v1::MeshEvent& event : events_after(messages)) {
    if (event.has_header()) {
      answers.push_back(event.header().has_kept() ? "kept parts" : "a whole mesh");
    } else if (event.has_refused()) {
      EXPECT_EQ(event.refused().code(), grpc::StatusCode::INVALID_ARGUMENT);
      EXPECT_FALSE(event.refused().details().empty());
      answers.push_back(event.refused().message());
    }
  }
  EXPECT_THAT(answers, ElementsAre("a whole mesh", "kept parts", HasSubstr("radius -1"),
                                   HasSubstr("leaves are set, but the session began with"),
                                   "kept parts"));
}

TEST_F(SessionFramesTest, EndsASessionWhoseClientDoesNotEndAFrame) {
  config_.session_idle_seconds = 2 * config_.stall_seconds;
  start();
  v1::RemeshRequest begin, part;
  *begin.mutable_start() = mesh_of(ball_file(12));
  part.mutable_part()->add_leaves()->set_values(std::string(4, '\0'));
  grpc::ClientContext context;
  const auto stream = meshes_->RemeshSession(&context);
  ASSERT_TRUE(stream->Write(begin));
  v1::MeshEvent event;
  while (!event.has_trailer()) ASSERT_TRUE(stream->Read(&event));
  ASSERT_TRUE(stream->Write(part));
  // Then the server waits for the rest, and no longer for what it has written.
  ASSERT_TRUE(eventually([&] { return activity().changed_grid_bytes > 0; }));
  const PassingTime passing(*server_, config_.stall_seconds);
  EXPECT_FALSE(stream->Read(&event));
  const grpc::Status status = stream->Finish();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::ABORTED) << status.error_message();
  EXPECT_THAT(status.error_message(), HasSubstr("sent no frame for"));
  EXPECT_TRUE(eventually([&] { return activity().changed_grid_bytes == 0; }));
}

/// Sessions that stay open after their second mesh.
class OpenSessions {
 public:
  /// Each message has so many bytes besides, in a field that nobody knows.
  OpenSessions(v1::MeshService::Stub& meshes, std::size_t unknown_bytes) {
    v1::RemeshRequest begin, frame;
    *begin.mutable_start() = request_of(two_balls(0));
    *frame.mutable_frame()->mutable_scene() = two_balls(0.1);
    add_unknown(unknown_bytes, *begin.mutable_start());
    add_unknown(unknown_bytes, *frame.mutable_frame()->mutable_scene());
    for (Session& session : sessions_) {
      session.stream = meshes.RemeshSession(&session.context);
      for (const v1::RemeshRequest& message : {begin, frame}) {
        EXPECT_TRUE(session.stream->Write(message));
        v1::MeshEvent event;
        while (!event.has_trailer() && session.stream->Read(&event)) {
        }
        EXPECT_TRUE(event.has_trailer());
      }
    }
  }
  ~OpenSessions() {
    for (Session& session : sessions_) {
      session.stream->WritesDone();
      EXPECT_TRUE(session.stream->Finish().ok());
    }
  }

 private:
  struct Session {
    grpc::ClientContext context;
    std::unique_ptr<grpc::ClientReaderWriter<v1::RemeshRequest, v1::MeshEvent>> stream;
  };

  static void add_unknown(std::size_t bytes, google::protobuf::Message& message) {
    message.GetReflection()->MutableUnknownFields(&message)->AddLengthDelimited(
        12345, std::string(bytes, 'x'));
  }

  std::array<Session, 8> sessions_;
};

/// By this process, which is the server, too.
std::uint64_t allocated_bytes() {
  const struct mallinfo2 now = ::mallinfo2();
  return now.uordblks + now.hblkhd;
}

TEST_F(SessionFramesTest, KeepNothingThatNoFieldIsKnownFor) {
  start();
  const OpenSessions plain(*meshes_, 0);
  const std::uint64_t before = allocated_bytes();
  const OpenSessions padded(*meshes_, std::size_t{3} << 20);
  // What is unknown is 48 MiB of what they sent.
  EXPECT_TRUE(
      eventually([&] { return allocated_bytes() < before + (std::uint64_t{24} << 20); }));
}

TEST_F(SessionFramesTest, ChargesPartsBeforeTheirFrameIsWhole) {
  config_.resident_bytes = 16 << 20;
  start();
  v1::RemeshRequest begin, part, frame;
  *begin.mutable_start() = mesh_of(ball_file(12));
  for (int i = 0; i < 500; ++i) {
    v1::LeafUpdate& leaf = *part.mutable_part()->add_leaves();
    leaf.set_x(8 * i);
    leaf.set_values(std::string(2048, '\0'));
  }
  frame.mutable_frame();
  std::vector<v1::RemeshRequest> messages{begin};
  messages.resize(21, part);  // 20 MB
  messages.push_back(frame);
  const grpc::Status status = answer_to(messages);
  EXPECT_EQ(reason_of(status), "tetstream/LIMIT_EXCEEDED") << status.error_message();
  EXPECT_THAT(status.error_message(), HasSubstr("sessions' changed grids"));
  EXPECT_TRUE(eventually([&] { return activity().changed_grid_bytes == 0; }));
}

}  // namespace
}  // namespace tet::test
