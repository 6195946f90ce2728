// What operators and their tools ask: health and reflection.
#include <gmock/gmock.h>
#include <grpcpp/generic/generic_stub.h>
#include <gtest/gtest.h>

#include "tests/server/service_fixture.h"

namespace tet::test {
namespace {

using testing::HasSubstr;

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
  for (const char* service : {"", "liveness", "readiness"}) {
    EXPECT_TRUE(client_->check_health(service, never_).ok()) << service;
  }
}

TEST_F(HealthTest, DoesNotKnowOtherServices) {
  EXPECT_EQ(client_->check_health("coffee", never_).code(), absl::StatusCode::kNotFound);
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
