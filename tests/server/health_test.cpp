// What operators and their tools ask: health and reflection.
#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>

#include <gmock/gmock.h>
#include <grpcpp/generic/generic_stub.h>
#include <gtest/gtest.h>

#include "grpc/health/v1/health.grpc.pb.h"
#include "tests/server/reason_of.h"
#include "tests/server/service_fixture.h"

namespace tet::test {
namespace {

using testing::HasSubstr;

using Health = grpc::health::v1::HealthCheckResponse;

/// One Watch call; given up with this.
class HealthWatch {
 public:
  HealthWatch(const std::shared_ptr<grpc::Channel>& channel, const std::string& service)
      : stub_(grpc::health::v1::Health::NewStub(channel)) {
    grpc::health::v1::HealthCheckRequest request;
    request.set_service(service);
    events_ = stub_->Watch(&context_, request);
  }
  ~HealthWatch() { cancel(); }
  HealthWatch(const HealthWatch&) = delete;
  HealthWatch& operator=(const HealthWatch&) = delete;

  /// Returns nothing where the call has ended.
  std::optional<Health::ServingStatus> next() {
    Health event;
    if (!events_->Read(&event)) return std::nullopt;
    return event.status();
  }

  /// Reads on until it tells this; false where the call ends before.
  bool comes_to(Health::ServingStatus wanted) {
    while (const auto told = next()) {
      if (told == wanted) return true;
    }
    return false;
  }

  grpc::Status end() {
    while (next()) {
    }
    return finish();
  }

  void cancel() {
    if (ended_) return;
    context_.TryCancel();
    end();
  }

 private:
  grpc::Status finish() {
    ended_ = true;
    return events_->Finish();
  }

  const std::unique_ptr<grpc::health::v1::Health::Stub> stub_;
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReader<Health>> events_;
  bool ended_ = false;
};

class HealthTest : public ServiceTest {
 protected:
  HealthTest() { start(); }

  /// Sends one message to a method and returns the first that comes back.
  std::string exchange(const std::string& method, const std::string& message) {
    grpc::GenericStub stub(channel_);
    grpc::ClientContext context;
    grpc::CompletionQueue queue;
    const auto wait = [&] {
      void* tag = nullptr;
      bool ok = false;
      return queue.Next(&tag, &ok) && ok;
    };
    const auto call = stub.PrepareCall(&context, method, &queue);
    call->StartCall(nullptr);
    EXPECT_TRUE(wait());
    const grpc::Slice slice(message);
    call->Write(grpc::ByteBuffer(&slice, 1), nullptr);
    EXPECT_TRUE(wait());
    grpc::ByteBuffer answer;
    call->Read(&answer, nullptr);
    EXPECT_TRUE(wait());
    grpc::Status status;
    context.TryCancel();
    call->Finish(&status, nullptr);
    EXPECT_TRUE(wait());
    queue.Shutdown();
    grpc::Slice whole;
    EXPECT_TRUE(answer.DumpToSingleSlice(&whole).ok());
    return {reinterpret_cast<const char*>(whole.begin()), whole.size()};
  }
};

TEST_F(HealthTest, IsServingFromTheStart) {
  const auto serves = [&] {
    return std::ranges::all_of(
        std::to_array<const char*>({"", "liveness", "readiness"}),
        [&](const char* service) { return client_->check_health(service, never_).ok(); });
  };
  // On a busy machine a store's first answer may take seconds: not that of every server.
  EXPECT_TRUE(eventually([&] {
    if (serves()) return true;
    restart();
    return false;
  }));
}

TEST_F(HealthTest, DoesNotKnowOtherServices) {
  EXPECT_EQ(client_->check_health("coffee", never_).code(), absl::StatusCode::kNotFound);
}

TEST_F(HealthTest, RefusesNamesThatNobodyHas) {
  EXPECT_EQ(client_->check_health(std::string(257, 'x'), never_).code(),
            absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(HealthWatch(channel_, std::string(257, 'x')).end().error_code(),
            grpc::StatusCode::INVALID_ARGUMENT);
}

TEST_F(HealthTest, TellsWatchersThatItWillEndWhileItGoesOn) {
  HealthWatch readiness(channel_, "readiness"), liveness(channel_, "liveness"),
      coffee(channel_, "coffee");
  EXPECT_TRUE(readiness.comes_to(Health::SERVING));
  EXPECT_EQ(liveness.next(), Health::SERVING);
  EXPECT_EQ(coffee.next(), Health::SERVICE_UNKNOWN);
  server_->announce_end();
  EXPECT_EQ(readiness.next(), Health::NOT_SERVING);
  EXPECT_FALSE(client_->check_health("", never_).ok());
  EXPECT_TRUE(client_->check_health("liveness", never_).ok());
  EXPECT_TRUE(client_->stream_mesh(uniform_ball(8), {}, never_).ok()) << "nothing is refused";
  server_->stop(0s);
  EXPECT_EQ(liveness.end().error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(coffee.end().error_code(), grpc::StatusCode::UNAVAILABLE);
}

TEST_F(HealthTest, LimitsWatchesOfOneHost) {
  config_.max_client_health_watches = 2;
  restart();
  HealthWatch first(channel_, ""), second(channel_, "");
  EXPECT_TRUE(first.comes_to(Health::SERVING));
  EXPECT_TRUE(second.comes_to(Health::SERVING));
  const grpc::Status third = HealthWatch(channel_, "").end();
  EXPECT_EQ(reason_of(third), "tetstream/QUOTA_EXCEEDED") << third.error_message();
  EXPECT_TRUE(comes_to_serve(*client_, ""));
  first.cancel();
  EXPECT_TRUE(eventually([&] { return HealthWatch(channel_, "").next().has_value(); }));
}

TEST_F(HealthTest, LimitsWatchesInAll) {
  config_.max_health_watches = 1;
  restart();
  HealthWatch first(channel_, "");
  EXPECT_TRUE(first.comes_to(Health::SERVING));
  const grpc::Status second = HealthWatch(channel_, "").end();
  EXPECT_EQ(reason_of(second), "tetstream/SERVER_BUSY") << second.error_message();
}

TEST_F(HealthTest, DescribesItsServices) {
  // ServerReflectionRequest { list_services: "" }
  const std::string services =
      exchange("/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo",
               std::string("\x3a\0", 2));
  EXPECT_THAT(services, HasSubstr("tetstream.v1.GridService"));
  EXPECT_THAT(services, HasSubstr("tetstream.v1.MeshService"));
}

}  // namespace
}  // namespace tet::test
