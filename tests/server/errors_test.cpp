// Every reason provoked over a real connection: what a client is told, held against a text
// file.
#include <algorithm>
#include <cmath>
#include <csignal>
#include <sys/resource.h>

#include <absl/strings/str_cat.h>
#include <gmock/gmock.h>
#include <grpcpp/generic/generic_stub.h>
#include <gtest/gtest.h>

#include "proto/convert/reasons.h"
#include "proto/convert/status.h"
#include "tests/server/held_place.h"
#include "tests/server/open_upload.h"
#include "tests/server/service_fixture.h"
#include "tests/server/status_text.h"

namespace tet::test {
namespace {

/// How the golden file is made anew: with this set to its path.
constexpr char kUpdateVariable[] = "TET_UPDATE_GOLDEN";

/// Those that no client can provoke, or is told by its own library first; and those that other
/// tests provoke, of decoders that misbehave, of servers with tokens, and of jobs.
// clang-format off
constexpr std::string_view kNotTold[] = {
    "CANCELLED",
    "CHUNK_DAMAGED",
    "DEADLINE_EXCEEDED",
    "DECODER_CRASHED",
    "DECODER_MEMORY",
    "DECODER_RESULT",
    "DECODER_TIMEOUT",
    "DECODER_UNAVAILABLE",
    "DETERMINISM_ALARM",
    "INTERNAL",
    "INVALID_DIGESTS",
    "INVALID_PLAN",
    "JOB_ACTIVE",
    "JOB_CANCELLED",
    "JOB_EXPIRED",
    "JOB_NOT_FOUND",
    "JOB_NOT_SUCCEEDED",
    "JOB_STORE_BROKEN",
    "JOB_STORE_FULL",
    "JOB_STORE_TOO_NEW",
    "JOB_STORE_UNAVAILABLE",
    "JOB_SUCCEEDED",
    "JOB_TIMEOUT",
    "LEASE_EXPIRED",
    "LEASE_LOST",
    "NO_ANSWER",
    "RANGE_BEYOND_MESH",
    "REQUEST_ID_REUSED",
    "RESULTS_FULL",
    "RESULTS_HELD_BY_JOBS",
    "REVISION_COMPACTED",
    "REVISION_UNKNOWN",
    "SCOPE_MISSING",
    "STORE_HELD_BY_JOBS",
    "TOKEN_EXPIRED",
    "TOKEN_MISSING",
    "TOKEN_UNKNOWN",
    "WRONG_STORE",
};
// clang-format on

class ErrorsTest : public ServiceTest {
 protected:
  ErrorsTest() {
    start_logging("off");
    config_.store_bytes = 4 << 20;
    start();
    ball_ = mesh_of(ball_file(8));
  }

  /// Takes what a call was told into the account.
  void tell(const std::string& how, const grpc::Status& status) {
    const google::rpc::Status rpc = details_of(status);
    const std::string message = status.error_message();
    EXPECT_LE(status.error_details().size(), kMaxStatusBytes) << how;
    EXPECT_THAT(message, testing::Not(testing::HasSubstr(folder_.path().string()))) << how;
    EXPECT_TRUE(std::all_of(message.begin(), message.end(), [](unsigned char c) {
      return c >= ' ' && c < 127;
    })) << how;
    told_.push_back(reason_in(status));
    // OpenVDB files differ each time that they are written, and a busy server looks late.
    absl::StrAppend(&account_, how, "\n  ", code_of(status), ": ",
                    without_seconds(without_digests(message)), "\n");
    for (const auto& detail : rpc.details()) account_ += text_of(detail);
  }

  static std::string code_of(const grpc::Status& status) {
    return absl::StatusCodeToString(static_cast<absl::StatusCode>(status.error_code()));
  }

  grpc::Status estimate(const v1::MeshRequest& mesh) {
    grpc::ClientContext context;
    v1::EstimateMeshRequest request;
    *request.mutable_mesh() = mesh;
    v1::MeshHeader header;
    return meshes_->EstimateMesh(&context, request, &header);
  }

  grpc::Status stream(const v1::StreamMeshRequest& request) {
    grpc::ClientContext context;
    const auto reader = meshes_->StreamMesh(&context, request);
    for (v1::MeshEvent event; reader->Read(&event);) {
    }
    return reader->Finish();
  }

  /// Announces `size` bytes and sends `text` at `offset`.
  grpc::Status upload(const std::string& name,
                      const std::string& text,
                      std::size_t size,
                      std::int64_t offset = 0) {
    return upload_text(*grids_, name, text, size, offset).status;
  }

  v1::MeshRequest named(const std::string& name) {
    v1::MeshRequest request;
    request.set_name(name);
    return request;
  }

  v1::MeshRequest stored_text(const std::string& text) {
    EXPECT_TRUE(upload(grid_name_of(text), text, text.size()).ok());
    return named(grid_name_of(text));
  }

  void wrong_requests();
  void wrong_scenes();
  void wrong_sizings();
  void wrong_fields();
  void wrong_grids();
  void wrong_streams();
  void wrong_uploads();
  void busy_store();
  void failing_disk();
  void damaged_store();
  void busy_server();
  void stalled_upload();
  void shutdown();

  v1::MeshRequest ball_;
  std::vector<std::string> told_;
  std::string account_;
};

void ErrorsTest::wrong_requests() {
  v1::MeshRequest request = ball_;
  request.set_spacing(0);
  tell("a spacing of 0", estimate(request));
  tell("a name that is none", estimate(named("/etc/passwd\n\x1b[31m")));
  grpc::ClientContext context;
  v1::FindMissingGridsRequest find;
  v1::FindMissingGridsResponse found;
  for (int i = 0; i < 1001; ++i) find.add_names(ball_.name());
  tell("1001 names", grids_->FindMissingGrids(&context, find, &found));
}

void ErrorsTest::wrong_scenes() {
  v1::MeshRequest request;
  request.mutable_scene()->add_nodes()->mutable_torus()->set_major_radius(1);
  tell("a scene's torus without a tube", estimate(request));
  request.mutable_scene()->mutable_nodes(0)->mutable_gyroid()->set_period(1);
  tell("a scene without an end", estimate(request));
  v1::GridSolid& grid = *request.mutable_scene()->mutable_nodes(0)->mutable_grid();
  tell("a scene's grid without a name", estimate(request));
  grid.set_name(grid_name_of("not stored"));
  tell("a scene's grid that is not stored", estimate(request));
  grid.set_name(ball_.name());
  grid.set_iso(1e6);
  tell("a scene's grid without a surface", estimate(request));
}

void ErrorsTest::wrong_sizings() {
  v1::MeshRequest request = ball_;
  v1::SizingRegion& region = *request.mutable_sizing()->add_regions();
  region.mutable_ball()->set_radius(1);
  tell("a sizing of 0", estimate(request));
  region.set_size(1e-4);
  tell("a sizing below the voxels' size", estimate(request));
  request.mutable_sizing()->set_growth(std::nan(""));
  tell("a sizing that grows by no number", estimate(request));
}

void ErrorsTest::wrong_fields() {
  const v1::MeshRequest ball = mesh_of(solid_file("fields", 0.25));
  v1::MeshRequest request = ball;
  request.set_grid_name("sphere");
  v1::Field& first = *request.add_fields();
  first.set_grid_name("heat");
  v1::Field& second = *request.add_fields();
  second.set_grid_name("wind");
  tell("a field that is not in the file", estimate(request));
  second.set_grid_name("heat");
  tell("two fields of one name, by their grids", estimate(request));
  first.set_name("heat");
  second.set_name("heat");
  tell("two fields of one name", estimate(request));
  second.set_name("a/b");
  tell("a field whose name no file can have", estimate(request));
  second.set_name("other");
  second.set_grid("grids/1");
  tell("a field in a file that is none", estimate(request));
  second.set_grid(grid_name_of("not stored"));
  tell("a field in a file that is not stored", estimate(request));
  second.clear_grid();
  second.clear_grid_name();
  tell("a field of several that could be meant", estimate(request));
  v1::StreamMeshRequest compact = stream_of(request);
  compact.set_encoding(v1::ENCODING_COMPACT);
  tell("fields in compact chunks", stream(compact));
  for (int i = 0; i < 15; ++i) request.add_fields();
  tell("17 fields", estimate(request));
  request = {};
  request.mutable_scene()->add_nodes()->mutable_sphere()->set_radius(1);
  request.add_fields()->set_grid_name("heat");
  tell("a field of a scene that names no file", estimate(request));
}

void ErrorsTest::wrong_grids() {
  tell("a file that is not stored", estimate(named(grid_name_of("not stored"))));
  v1::MeshRequest request = ball_;
  request.set_grid_name("density");
  tell("a grid that is not in the file", estimate(request));
  tell("a grid of vectors", estimate(mesh_of(solid_file("vec3", 0.1))));
  request = ball_;
  request.set_iso(-10);
  tell("an iso value that nothing is below", estimate(request));
  tell("text in place of a grid", estimate(stored_text("this is no grid")));
}

void ErrorsTest::wrong_streams() {
  tell("chunks beyond the mesh", stream(stream_of(ball_, 1000, 1001)));
  v1::StreamMeshRequest request = stream_of(ball_);
  request.set_expected_mesh_id("another");
  tell("another mesh than was expected", stream(request));
  const std::string bytes = "\xff\xff";
  const grpc::Slice slice(bytes);
  const grpc::ByteBuffer message(&slice, 1);
  grpc::ByteBuffer response;
  grpc::ClientContext context;
  grpc::CompletionQueue queue;
  grpc::GenericStub stub(channel_);
  const auto call =
      stub.PrepareUnaryCall(&context, "/tetstream.v1.MeshService/StreamMesh", message, &queue);
  grpc::Status status;
  call->StartCall();
  call->Finish(&response, &status, nullptr);
  void* tag = nullptr;
  bool ok = false;
  queue.Next(&tag, &ok);
  tell("bytes that are no request", status);
}

void ErrorsTest::wrong_uploads() {
  const std::string text = "0123456789";
  tell("an upload beyond its size", upload(grid_name_of("a"), text, 5));
  tell("an upload at another offset", upload(grid_name_of("a"), text, 100, 7));
  tell("an upload of other bytes", upload(grid_name_of("a"), text, 10));
  v1::UploadGridResponse response;
  grpc::ClientContext context;
  const auto writer = grids_->UploadGrid(&context, &response);
  v1::UploadGridRequest data;
  data.mutable_data()->set_data(text);
  writer->Write(data);
  tell("data before the start", writer->Finish());
}

void ErrorsTest::busy_store() {
  OpenUpload large(*grids_, grid_name_of("large"), 3 << 20);
  large.send("l");
  ASSERT_TRUE(upload_begins(grid_name_of("large")));
  tell("the same upload twice", upload(grid_name_of("large"), "l", 3 << 20));
  tell("an upload with no room beside another", upload(grid_name_of("other"), "o", 2 << 20));
  large.cancel();
}

// A limit on the file's size stands for the disk's end: both fail in the middle of a write.
void ErrorsTest::failing_disk() {
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit old{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &old), 0);
  const rlimit tight{5, old.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &tight), 0);
  const grpc::Status full = upload(grid_name_of("full"), "0123456789", 10);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &old), 0);
  tell("a disk that is full", full);

  const std::filesystem::path uploads = config_.store + "/uploads";
  std::filesystem::remove_all(uploads);
  std::ofstream(uploads) << "in the way";
  tell("a disk that fails", upload(grid_name_of("failing"), "0123456789", 10));
  std::filesystem::remove(uploads);
  std::filesystem::create_directories(uploads);
}

void ErrorsTest::damaged_store() {
  const v1::MeshRequest request = mesh_of(solid_file("torus", 0.1));
  restart();
  const std::string digest = request.name().substr(6);
  std::filesystem::resize_file(config_.store + "/grids/" + digest.substr(0, 2) + "/" + digest,
                               10);
  tell("a stored file that lost its end", estimate(request));
}

void ErrorsTest::busy_server() {
  config_.max_streams = 1;
  config_.max_queued = 0;
  config_.max_client_uploads = 1;
  restart();
  HeldPlace held(*server_);
  tell("a mesh beside as many as may be", estimate(ball_));
  held.let_go();
}

void ErrorsTest::stalled_upload() {
  OpenUpload first(*grids_, grid_name_of("first"), 10);
  ASSERT_TRUE(upload_begins(grid_name_of("first")));
  tell("a client's second upload of one", upload(grid_name_of("second"), "s", 10));
  first.cancel();
  config_.stall_seconds = 1;
  restart();
  tell("an upload that does not go on", OpenUpload(*grids_, grid_name_of("first"), 10).wait());
  config_.stall_seconds = 3600;
  restart();
}

void ErrorsTest::shutdown() {
  grpc::ClientContext context;
  v1::StreamMeshRequest request = stream_of(uniform_ball(60));
  const auto reader = meshes_->StreamMesh(&context, request);
  v1::MeshEvent event;
  ASSERT_TRUE(reader->Read(&event));
  std::thread stopping([&] { server_->stop(kGenerousEnd); });
  ASSERT_TRUE(eventually([&] { return server_->engine().calls.admission().is_ending(); }));
  tell("a server that stops", estimate(ball_));
  context.TryCancel();
  while (reader->Read(&event)) {
  }
  reader->Finish();
  stopping.join();
}

TEST_F(ErrorsTest, SayTheirReasonAndNoMoreThanTheyShould) {
  wrong_requests();
  wrong_scenes();
  wrong_sizings();
  wrong_fields();
  wrong_grids();
  wrong_streams();
  wrong_uploads();
  busy_store();
  failing_disk();
  damaged_store();
  busy_server();
  stalled_upload();
  shutdown();
  if (const char* path = std::getenv(kUpdateVariable)) std::ofstream(path) << account_;
  EXPECT_EQ(account_, read_text(ERRORS_GOLDEN));
  for (const std::string_view reason : kReasons) {
    const bool not_told = std::count(std::begin(kNotTold), std::end(kNotTold), reason) > 0;
    EXPECT_EQ(std::count(told_.begin(), told_.end(), reason) > 0, !not_told) << reason;
  }
}

TEST_F(ErrorsTest, StaySmallWhateverTheRequestHolds) {
  v1::MeshRequest request = ball_;
  request.set_grid_name(std::string(1 << 20, 'x'));
  const grpc::Status status = estimate(request);
  EXPECT_EQ(reason_in(status), "GRID_NOT_IN_FILE");
  EXPECT_LE(status.error_details().size(), kMaxStatusBytes);
}

}  // namespace
}  // namespace tet::test
