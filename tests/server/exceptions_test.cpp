// Exceptions that nobody foresaw: each costs the call that it is thrown in, and nothing else.
#include <stdexcept>
#include <thread>

#include <gmock/gmock.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/server_builder.h>
#include <gtest/gtest.h>

#include "server/ops/guard.h"
#include "server/rpc/calls.h"
#include "server/rpc/handler_watch.h"
#include "tests/server/reason_of.h"
#include "tests/support/eventually.h"
#include "tetstream/v1/jobs.grpc.pb.h"
#include "tetstream/v1/meshes.grpc.pb.h"

namespace tet::test {
namespace {

namespace v1 = ::tetstream::v1;

[[noreturn]] void fail() { throw std::length_error("the server's own affair"); }

/// A service whose every method fails in a way of its own.
class Failing final : public v1::JobService::CallbackService {
 public:
  Failing() : access_(*Access::open("")) {}

  grpc::ServerUnaryReactor* GetJob(grpc::CallbackServerContext*,
                                   const v1::GetJobRequest*,
                                   v1::Job*) override {
    fail();
  }
  grpc::ServerWriteReactor<v1::JobEvent>* WatchJobs(grpc::CallbackServerContext*,
                                                    const v1::WatchJobsRequest*) override {
    fail();
  }
  grpc::ServerUnaryReactor* ListJobs(grpc::CallbackServerContext* context,
                                     const v1::ListJobsRequest*,
                                     v1::ListJobsResponse*) override {
    return answer(registry_, threads_, *context, "ListJobs",
                  [](const Call&) -> absl::Status { fail(); });
  }
  grpc::ServerUnaryReactor* CancelJob(grpc::CallbackServerContext* context,
                                      const v1::CancelJobRequest*,
                                      v1::Job*) override {
    return answer_later(registry_, threads_, *context, "CancelJob",
                        [](const std::shared_ptr<PendingAnswer>&) { fail(); });
  }
  grpc::ServerUnaryReactor* RetryJob(grpc::CallbackServerContext* context,
                                     const v1::RetryJobRequest*,
                                     v1::Job*) override {
    return answer_later(registry_, threads_, *context, "RetryJob",
                        [](const std::shared_ptr<PendingAnswer>& pending) {
                          pending->finish(absl::OkStatus());
                          fail();
                        });
  }
  int running() const { return registry_.running(); }

 private:
  static AdmissionLimits some_calls() {
    AdmissionLimits limits;
    limits.calls = {8, 8};
    return limits;
  }

  std::unique_ptr<Access> access_;
  Admission admission_{some_calls()};
  CallRegistry registry_{*access_, admission_};
  FairTasks threads_{pool_};
  TaskPool pool_{2};  // ends first: a task is charged once it is done
};

class ExceptionsTest : public testing::Test {
 protected:
  ExceptionsTest() {
    start_logging("off");
    log_contained_exceptions();
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    std::vector<std::unique_ptr<grpc::experimental::ServerInterceptorFactoryInterface>> watches;
    watches.push_back(watch_handlers({v1::JobService::service_full_name()}));
    builder.experimental().SetInterceptorCreators(std::move(watches));
    builder.RegisterService(&service_);
    server_ = builder.BuildAndStart();
    channel_ = grpc::CreateChannel("127.0.0.1:" + std::to_string(port),
                                   grpc::InsecureChannelCredentials());
    jobs_ = v1::JobService::NewStub(channel_);
  }

  template <class Request, class Response>
  grpc::Status call(grpc::Status (v1::JobService::Stub::*method)(grpc::ClientContext*,
                                                                 const Request&,
                                                                 Response*)) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kGenerousEnd);
    Response response;
    return (jobs_.get()->*method)(&context, Request(), &response);
  }

  static void expect_internal(const grpc::Status& status) {
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INTERNAL) << status.error_message();
    EXPECT_EQ(reason_of(status), "tetstream/INTERNAL");
    EXPECT_THAT(status.error_message(), testing::Not(testing::HasSubstr("own affair")));
  }

  Failing service_;
  std::unique_ptr<grpc::Server> server_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<v1::JobService::Stub> jobs_;
};

TEST_F(ExceptionsTest, InAHandlerAreToldAsInternal) {
  expect_internal(call(&v1::JobService::Stub::GetJob));
  grpc::ClientContext context;
  const auto events = jobs_->WatchJobs(&context, v1::WatchJobsRequest());
  v1::JobEvent event;
  EXPECT_FALSE(events->Read(&event));
  expect_internal(events->Finish());
}

TEST_F(ExceptionsTest, AreNotSuspectedOfMethodsThatThereAreNot) {
  grpc::ClientContext context;
  google::protobuf::Empty response;
  EXPECT_EQ(jobs_->DeleteJob(&context, {}, &response).error_code(),
            grpc::StatusCode::INTERNAL);  // there is, and nobody has implemented it
  grpc::ClientContext other;
  v1::MeshService::Stub meshes(channel_);
  v1::Capabilities capabilities;
  EXPECT_EQ(meshes.GetCapabilities(&other, {}, &capabilities).error_code(),
            grpc::StatusCode::UNIMPLEMENTED);
}

TEST_F(ExceptionsTest, InTheWorkOfACallAreToldAsInternal) {
  expect_internal(call(&v1::JobService::Stub::ListJobs));
  expect_internal(call(&v1::JobService::Stub::CancelJob));
}

TEST_F(ExceptionsTest, AfterTheAnswerChangeNothing) {
  EXPECT_TRUE(call(&v1::JobService::Stub::RetryJob).ok());
  EXPECT_TRUE(eventually([&] { return service_.running() == 0; }));
}

TEST(Guarded, TellsWhatWasThrownAsAFailureWithoutItsWords) {
  const absl::Status failed = guarded("a test", [] { fail(); });
  EXPECT_EQ(failed.code(), absl::StatusCode::kInternal);
  EXPECT_EQ(failed.message(), "the server failed in a test: report it with the request's id");
  EXPECT_EQ(guarded("a test", [] {}), absl::OkStatus());
  EXPECT_EQ(guarded("a test", [] { return absl::StatusOr<int>(7); }).value(), 7);
}

}  // namespace
}  // namespace tet::test
