#include "server/streams/chunk_stream.h"

#include <atomic>
#include <functional>
#include <memory>

#include <grpcpp/server_builder.h>
#include <gtest/gtest.h>

#include "tests/server/service_fixture.h"

namespace tet::test {
namespace {

/// Work that ends only when it is cancelled, or the test does.
struct EndlessWork {
  std::atomic<bool> begun{false}, cancelled{false}, let_go{false};
};

/// A stream whose only chunk cannot be made, while what its trailer would tell is in work.
class BreakingStream final : public ChunkStream {
 public:
  using Reactor = grpc::ServerWriteReactor<grpc::ByteBuffer>;

  static Reactor* start(MeshEngine& engine,
                        grpc::CallbackServerContext& context,
                        EndlessWork& endless) {
    const std::shared_ptr<BreakingStream> stream(new BreakingStream(engine, context, endless));
    return ChunkStream::start(stream, absl::OkStatus());
  }

 private:
  BreakingStream(MeshEngine& engine, grpc::CallbackServerContext& context, EndlessWork& endless)
      : ChunkStream(engine, context, "StreamMesh"), endless_(endless) {}

  void open() override { begin_chunks(absl::OkStatus(), 0, 0); }
  std::uint64_t chunk_count() const override { return 1; }
  v1::MeshEvent header() const override { return {}; }
  absl::StatusOr<ChunkMessage> make(std::uint64_t /*index*/, Block /*block*/) override {
    EXPECT_TRUE(eventually([&] { return endless_.begun.load(); }));
    return absl::DataLossError("a chunk that cannot be made");
  }
  v1::MeshEvent trailer(std::uint64_t /*first*/,
                        std::uint64_t /*end*/,
                        const QualityStats& /*quality*/) const override {
    return {};
  }
  std::function<absl::Status()> work_for_trailer() override {
    return [watch = watch_, &endless = endless_] {
      endless.begun = true;
      eventually([&] { return watch->cancellation.requested() || endless.let_go; });
      endless.cancelled = watch->cancellation.requested();
      return absl::OkStatus();
    };
  }

  EndlessWork& endless_;
};

class BreakingService final
    : public v1::MeshService::WithRawCallbackMethod_StreamMesh<v1::MeshService::Service> {
 public:
  BreakingService(MeshEngine& engine, EndlessWork& endless)
      : engine_(engine), endless_(endless) {}
  BreakingStream::Reactor* StreamMesh(grpc::CallbackServerContext* context,
                                      const grpc::ByteBuffer* /*request*/) override {
    return BreakingStream::start(engine_, *context, endless_);
  }

 private:
  MeshEngine& engine_;
  EndlessWork& endless_;
};

using ChunkStreamTest = ServiceTest;

TEST_F(ChunkStreamTest, EndsItsWorkWithItselfWhateverEndsIt) {
  start();
  EndlessWork endless;
  BreakingService service(const_cast<MeshEngine&>(server_->engine()), endless);
  const auto breaking = grpc::ServerBuilder().RegisterService(&service).BuildAndStart();
  ASSERT_NE(breaking, nullptr);
  const auto meshes = v1::MeshService::NewStub(breaking->InProcessChannel({}));
  grpc::ClientContext context;
  const auto reader = meshes->StreamMesh(&context, {});
  for (v1::MeshEvent event; reader->Read(&event);) {
  }
  EXPECT_EQ(reader->Finish().error_code(), grpc::StatusCode::DATA_LOSS);
  EXPECT_TRUE(eventually([&] { return endless.cancelled.load(); }));
  endless.let_go = true;
  breaking->Shutdown();
  server_.reset();  // once the work is done
}

}  // namespace
}  // namespace tet::test
