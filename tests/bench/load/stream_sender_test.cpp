#include "bench/load/stream_sender.h"

#include <atomic>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>
#include <gtest/gtest.h>

#include "bench/load/run_load.h"
#include "proto/wire/checksum.h"
#include "tests/bench/load/stand_in.h"
#include "tests/support/eventually.h"
#include "tests/support/unused_port.h"
#include "tetstream/v1/meshes.grpc.pb.h"

namespace tet::load {
namespace {

namespace v1 = ::tetstream::v1;
using testing::HasSubstr;
using namespace std::chrono_literals;

/// Sends two chunks of ten tets each, unless told to do otherwise.
class TwoChunks final : public v1::MeshService::Service {
 public:
  std::function<void(v1::MeshChunk&)> spoil = [](v1::MeshChunk&) {};
  std::atomic<int> chunks = 2;
  std::atomic<bool> hangs = false;
  std::atomic<bool> refuses = false;
  /// Calls without a deadline that have come to hang.
  std::atomic<int> hanging = 0;
  /// How long, from the first call on, calls that begin wait for its end.
  std::atomic<Nanoseconds> stall = Nanoseconds{0};

  grpc::Status StreamMesh(grpc::ServerContext* context,
                          const v1::StreamMeshRequest* /*request*/,
                          grpc::ServerWriter<v1::MeshEvent>* writer) override {
    if (refuses) return {grpc::StatusCode::RESOURCE_EXHAUSTED, "two are enough"};
    const bool has_deadline =
        context->deadline() != std::chrono::system_clock::time_point::max();
    if (hangs && !has_deadline) ++hanging;
    while (hangs && !context->IsCancelled()) std::this_thread::sleep_for(1ms);
    std::call_once(first_call_, [this] { stalled_until_ = Clock::now() + stall.load(); });
    std::this_thread::sleep_until(stalled_until_);
    v1::MeshEvent header, trailer;
    header.mutable_header()->set_chunk_count(2);
    header.mutable_header()->set_tet_count(20);
    writer->Write(header);
    for (int i = 0; i < chunks; ++i) writer->Write(event_of_chunk(i));
    trailer.mutable_trailer()->set_end_chunk(2);
    if (chunks == 2) writer->Write(trailer);
    return grpc::Status::OK;
  }

 private:
  v1::MeshEvent event_of_chunk(int index) const {
    v1::MeshEvent event;
    v1::MeshChunk& chunk = *event.mutable_chunk();
    chunk.set_index(index);
    chunk.set_first_tet(10 * index);
    chunk.set_tet_count(10);
    chunk.set_positions("0123456789");
    chunk.set_tets("abcdef");
    chunk.set_checksum(
        chunk_checksum({chunk.positions(), chunk.tets(), chunk.regions(), chunk.fields()}));
    spoil(chunk);
    return event;
  }

  std::once_flag first_call_;
  TimePoint stalled_until_{};
};

class StreamSenderTest : public testing::Test {
 protected:
  StreamSenderTest() {
    int port = 0;
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(&service_);
    server_ = builder.BuildAndStart();
    settings_.address = "127.0.0.1:" + std::to_string(port);
    settings_.connections = 2;
    settings_.patience = tet::test::kGenerousEnd;
  }

  /// Throws, which fails the test alone, where there is none.
  std::unique_ptr<RequestSender> open() { return open_stream_sender(settings_).value(); }

  Outcome send(RequestSender& sender, std::optional<Nanoseconds> timeout = {}) {
    LoadRequest request;
    request.intended = Clock::now();
    if (timeout) request.give_up = request.intended + *timeout;
    std::promise<Outcome> promise;
    sender.send(request, [&](const Outcome& outcome) { promise.set_value(outcome); });
    return promise.get_future().get();
  }

  TwoChunks service_;
  std::unique_ptr<grpc::Server> server_;
  StreamSettings settings_;
};

TEST_F(StreamSenderTest, CountsAWholeMeshAndItsMoments) {
  const auto sender = open();
  const TimePoint start = Clock::now();
  const Outcome outcome = send(*sender);
  ASSERT_TRUE(outcome.status.ok()) << outcome.status;
  EXPECT_EQ(outcome.tets, 20u);
  EXPECT_EQ(outcome.bytes, 32u);
  EXPECT_LE(start, outcome.sent);
  EXPECT_LE(outcome.sent, *outcome.header);
  EXPECT_LE(*outcome.header, *outcome.first_chunk);
  EXPECT_LE(*outcome.first_chunk, outcome.ended);
  EXPECT_EQ(sender->traffic().tets, 20u);
  EXPECT_EQ(sender->traffic().bytes, 32u);
}

TEST_F(StreamSenderTest, FindsAWrongChecksumWhenAsked) {
  service_.spoil = [](v1::MeshChunk& chunk) { chunk.set_checksum(chunk.checksum() + 1); };
  EXPECT_TRUE(send(*open()).status.ok());
  settings_.check_columns = true;
  const Outcome outcome = send(*open());
  EXPECT_TRUE(absl::IsDataLoss(outcome.status));
  EXPECT_THAT(std::string(outcome.status.message()), HasSubstr("chunk 0 has a wrong checksum"));
}

TEST_F(StreamSenderTest, FindsAChunkOutOfPlaceAndAStreamThatIsShort) {
  service_.spoil = [](v1::MeshChunk& chunk) { chunk.set_first_tet(0); };
  EXPECT_TRUE(absl::IsDataLoss(send(*open()).status));
  service_.spoil = [](v1::MeshChunk&) {};
  service_.chunks = 1;
  const Outcome outcome = send(*open());
  EXPECT_TRUE(absl::IsDataLoss(outcome.status));
  EXPECT_THAT(std::string(outcome.status.message()),
              HasSubstr("after 1 of 2 chunks and 10 of 20 tets"));
}

TEST_F(StreamSenderTest, TellsTheServersRefusal) {
  service_.refuses = true;
  const Outcome outcome = send(*open());
  EXPECT_TRUE(absl::IsResourceExhausted(outcome.status));
  EXPECT_EQ(outcome.status.message(), "two are enough");
}

TEST_F(StreamSenderTest, KeepsADeadlineAndGivesUpWhenTold) {
  service_.hangs = true;
  const auto sender = open();
  EXPECT_TRUE(absl::IsDeadlineExceeded(send(*sender, 50ms).status));
  // The first call may reach the service only now that its client has left: it is not counted.
  std::jthread stopper([&] {
    EXPECT_TRUE(tet::test::eventually([&] { return service_.hanging > 0; }));
    sender->give_up();
  });
  EXPECT_TRUE(absl::IsCancelled(send(*sender).status));
}

TEST_F(StreamSenderTest, WaitsForItsCallsBeforeItIsGone) {
  service_.hangs = true;
  std::atomic<int> ended = 0;
  {
    const auto sender = open();
    LoadRequest request;
    for (int i = 0; i < 20; ++i) sender->send(request, [&](const Outcome&) { ++ended; });
  }
  EXPECT_EQ(ended, 20);
}

TEST_F(StreamSenderTest, SaysWhenThereIsNoServer) {
  const tet::test::UnusedPort port;  // at which nobody listens
  settings_.address = port.address();
  settings_.patience = 100ms;
  const auto sender = open_stream_sender(settings_);
  EXPECT_TRUE(absl::IsUnavailable(sender.status()));
}

// Coordinated omission, over a real connection: the server answers nothing for a second.
TEST_F(StreamSenderTest, ShowsAStallOfASecondInTheUpperPercentiles) {
  const auto sender = open();
  LoadPlan plan;
  plan.steps = {{100, 1.5}};
  plan.warm_up_seconds = 0;
  plan.max_outstanding = 2;
  plan.drain = tet::test::kGenerousEnd;
  RequestMix mix = test::mix_of_one();
  const Cancellation never;
  service_.stall = 1s;
  const LoadResult result = run_load(plan, mix, *sender, never, {});
  const LatencyHistogram whole = result.total.latency(LatencyKind::kWhole);
  EXPECT_EQ(result.total.done, result.total.offered);
  // Two thirds of the requests fell due in the stall, although only two were sent in it.
  EXPECT_GT(whole.quantile(0.99), 900ms);
  EXPECT_GT(whole.quantile(0.5), 150ms);
}

}  // namespace
}  // namespace tet::load
