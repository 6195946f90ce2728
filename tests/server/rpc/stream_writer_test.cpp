#include "server/rpc/stream_writer.h"

#include <memory>
#include <utility>

#include <grpcpp/server_builder.h>
#include <gtest/gtest.h>

#include "proto/convert/status.h"
#include "server/ops/logging.h"
#include "tests/server/reason_of.h"
#include "tetstream/v1/meshes.grpc.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

namespace {

/// A stream whose work ends it in its own way as soon as it is abandoned.
class HastyStream final : public grpc::ServerWriteReactor<v1::MeshEvent>, public StreamWriter {
 public:
  static HastyStream* start(CallRegistry& calls, grpc::CallbackServerContext& context) {
    const std::shared_ptr<HastyStream> stream(new HastyStream(calls, context));
    stream->kept_ = stream;
    stream->break_off(
        with_reason(absl::InvalidArgumentError("not what was asked for"), "MESSAGE_ORDER"));
    return stream.get();
  }

 private:
  HastyStream(CallRegistry& calls, grpc::CallbackServerContext& context)
      : StreamWriter(calls, context, "StreamMesh") {}

  void OnCancel() override { cancelled(); }
  void OnDone() override {
    const std::shared_ptr<HastyStream> last = std::move(kept_);  // goes with this
  }
  bool prepare() override { return false; }
  void write() override {}
  void finish(const grpc::Status& status) override { Finish(status); }
  void abandon() override { close(client_gone(Cancellation())); }

  std::shared_ptr<HastyStream> kept_;  ///< until gRPC is done
};

class HastyService final : public v1::MeshService::CallbackService {
 public:
  explicit HastyService(CallRegistry& calls) : calls_(calls) {}
  grpc::ServerWriteReactor<v1::MeshEvent>* StreamMesh(
      grpc::CallbackServerContext* context, const v1::StreamMeshRequest* /*request*/) override {
    return HastyStream::start(calls_, *context);
  }

 private:
  CallRegistry& calls_;
};

TEST(StreamWriter, EndsWithWhyItIsBrokenOffAndNotWithWhatComesOfThat) {
  start_logging("error");
  const auto access = Access::open("");
  ASSERT_TRUE(access.ok()) << access.status();
  AdmissionLimits limits;
  limits.calls = {1, 1};
  Admission admission(limits);
  CallRegistry calls(**access, admission);
  HastyService service(calls);
  grpc::ServerBuilder builder;
  const auto server = builder.RegisterService(&service).BuildAndStart();
  ASSERT_NE(server, nullptr);
  const auto meshes = v1::MeshService::NewStub(server->InProcessChannel({}));
  grpc::ClientContext context;
  const auto reader = meshes->StreamMesh(&context, {});
  v1::MeshEvent event;
  EXPECT_FALSE(reader->Read(&event));
  EXPECT_EQ(test::reason_of(reader->Finish()), "tetstream/MESSAGE_ORDER");
}

}  // namespace
}  // namespace tet
