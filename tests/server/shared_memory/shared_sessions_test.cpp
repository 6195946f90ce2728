// Sessions whose frames come in shared memory: the same bytes, in one ring.
#include <memory>
#include <sys/stat.h>
#include <vector>

#include <gtest/gtest.h>

#include "core/mesh/stable/stable_mesh.h"
#include "tests/core/plan/meshing.h"
#include "tests/server/plain_channel.h"
#include "tests/server/reason_of.h"
#include "tests/server/session_fixture.h"
#include "tests/server/shared_memory_fixture.h"

namespace tet::test {
namespace {

constexpr SessionIds kBothIds[] = {SessionIds::kInOrder, SessionIds::kStable};

bool has_bytes_of(const RemeshSession& session, const TetMesh& whole) {
  if (session.stable() == nullptr) return same_bytes(session.mesh().mesh, whole);
  return same_bytes(session.stable()->in_order().value(), whole);
}

/// A session of a client that may do as it likes.
class WilfulSession {
 public:
  explicit WilfulSession(const std::string& socket)
      : client_(socket),
        meshes_(v1::MeshService::NewStub(plain_channel("unix:" + socket))),
        stream_(meshes_->RemeshSession(&context_)) {}

  /// Asks for a mesh.
  void ask(v1::RemeshRequest message) {
    if (message.has_start()) message.set_shared_memory(client_.token());
    stream_->Write(message);
  }
  /// Reads as far as the mesh's header.
  void read_header() {
    event_.Clear();
    while (stream_->Read(&event_) && !event_.has_header()) {
    }
  }
  void frame(const v1::RemeshRequest& message) {
    ask(message);
    read_header();
  }
  bool has_ring() const { return event_.header().has_shared_memory(); }
  /// Reads on as far as the trailer, and acknowledges what comes, or does not.
  void follow(bool acknowledges) {
    std::uint64_t index = 0;
    while (!event_.has_trailer() && stream_->Read(&event_)) {
      if (event_.has_chunk() && acknowledges) client_.say(index++);
    }
  }
  WilfulClient& client() { return client_; }
  grpc::Status end() {
    stream_->WritesDone();
    while (stream_->Read(&event_)) {
    }
    return stream_->Finish();
  }

 private:
  WilfulClient client_;
  grpc::ClientContext context_;
  std::unique_ptr<v1::MeshService::Stub> meshes_;
  std::unique_ptr<grpc::ClientReaderWriter<v1::RemeshRequest, v1::MeshEvent>> stream_;
  v1::MeshEvent event_;
};

v1::RemeshRequest start_of(const v1::MeshRequest& request) {
  v1::RemeshRequest message;
  *message.mutable_start() = request;
  return message;
}

v1::RemeshRequest frame_of(const v1::Scene& scene) {
  v1::RemeshRequest message;
  *message.mutable_frame()->mutable_scene() = scene;
  return message;
}

class SharedSessions : public SharedMemoryTest {};

TEST_F(SharedSessions, EachFrameIsTheMeshOfItsScene) {
  start();
  const auto client = local();
  for (const SessionIds ids : kBothIds) {
    const auto session = client->begin_session(request_of(two_balls(0)), never_, ids);
    ASSERT_TRUE(session.ok()) << session.status();
    EXPECT_TRUE((*session)->mesh().shared_memory);
    for (const double x : {0.02, 0.02, 1.5, 0.3}) {
      ASSERT_EQ((*session)->update(two_balls(x)), absl::OkStatus());
      const StreamedMesh& mesh = (*session)->mesh();
      EXPECT_TRUE(mesh.shared_memory);
      const StreamedMesh whole = received(*client_, mesh.canonical_request);
      EXPECT_TRUE(has_bytes_of(**session, whole.mesh)) << x;
    }
    EXPECT_EQ((*session)->end(), absl::OkStatus());
  }
  EXPECT_EQ(shared_streams(), 2);
  EXPECT_TRUE(work_stops());
  EXPECT_TRUE(eventually([&] { return engine().send_budget.used_bytes() == kept_bytes(); }));
}

TEST_F(SharedSessions, AFrameThatIsRefusedLeavesTheNextItsMemory) {
  start();
  const auto session = local()->begin_session(request_of(two_balls(0)), never_);
  ASSERT_TRUE(session.ok()) << session.status();
  v1::Scene unknown = two_balls(0);
  unknown.mutable_nodes()->rbegin()->mutable_union_()->add_of("nobody");
  EXPECT_FALSE((*session)->update(unknown).ok());
  ASSERT_EQ((*session)->update(two_balls(0.5)), absl::OkStatus());
  EXPECT_TRUE((*session)->mesh().shared_memory);
  const StreamedMesh whole = received(*client_, (*session)->mesh().canonical_request);
  EXPECT_TRUE(same_bytes(whole.mesh, (*session)->mesh().mesh));
}

TEST_F(SharedSessions, FramesHaveOneMemoryAndSoHasTheNextStream) {
  start();
  WilfulSession session(socket_);
  v1::MeshRequest request = request_of(two_balls(0));
  request.set_spacing(0.02);
  ino_t number = 0;
  for (const double x : {0.0, 0.5, 1.0}) {
    session.frame(x == 0 ? start_of(request) : frame_of(two_balls(x)));
    ASSERT_TRUE(session.has_ring());
    struct stat told {};
    ASSERT_EQ(::fstat(session.client().take_memory().number(), &told), 0);
    if (x == 0) number = told.st_ino;
    EXPECT_EQ(told.st_ino, number);
    session.follow(true);
  }
  EXPECT_TRUE(session.end().ok());
  WilfulClient& client = session.client();
  client.begin(stream_of(request), client.token());
  ASSERT_TRUE(client.has_ring());
  struct stat told {};
  ASSERT_EQ(::fstat(client.take_memory().number(), &told), 0);
  EXPECT_EQ(told.st_ino, number);
  EXPECT_TRUE(client.follow().ok());
}

TEST_F(SharedSessions, AFrameThatNobodyAcknowledgesIsTheLast) {
  config_.session_idle_seconds = 2 * config_.stall_seconds;  // that is not what ends it
  start();
  const std::string reason = reason_when_stalled([&] {
    WilfulSession session(socket_);
    session.frame(start_of(request_of(two_balls(0))));
    EXPECT_TRUE(session.has_ring());
    session.client().take_memory();
    session.follow(false);
    session.ask(frame_of(two_balls(1)));
    const PassingTime passing(*server_, config_.stall_seconds);
    session.read_header();
    EXPECT_FALSE(session.has_ring());
    return session.end();
  });
  EXPECT_EQ(reason, "tetstream/CLIENT_STALLED");
  EXPECT_TRUE(work_stops());
  EXPECT_EQ(kept_bytes(), 0U);
}

TEST_F(SharedSessions, FramesGoOnAsMessagesForWhoeverTakesNoMemory) {
  start();
  WilfulSession session(socket_);
  session.frame(start_of(request_of(two_balls(0))));
  ASSERT_TRUE(session.has_ring());
  session.follow(true);  // which was told of memory, and left it
  session.frame(frame_of(two_balls(1)));
  EXPECT_FALSE(session.has_ring());
  session.follow(false);
  EXPECT_TRUE(session.end().ok());
}

}  // namespace
}  // namespace tet::test
