// A JobService in the test's own process that does as it is told.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>

#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include "client/library/connection.h"
#include "proto/convert/status.h"
#include "proto/wire/transport.h"
#include "tetstream/v1/jobs.grpc.pb.h"

namespace tet::test {

namespace v1 = ::tetstream::v1;

/// What the service answers, set by the test before the first call. Each call is one of several
/// in turn, counted from 1.
class PlayedJobs final : public v1::JobService::Service {
 public:
  using Get = std::function<absl::Status(int call, const std::string& name, v1::Job&)>;
  using Tell = std::function<void(const v1::JobEvent&)>;
  using Watch = std::function<absl::Status(int call, const Tell& tell)>;

  Get get;
  Watch watch;
  bool begins_watches = true;  ///< else it is as a proxy before a server that hangs

  /// The address that it serves from then on.
  std::string listen() {
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(this);
    server_ = builder.BuildAndStart();
    return "127.0.0.1:" + std::to_string(port);
  }
  std::shared_ptr<Connection> connect(RetryPolicy retry) {
    const auto connection = Connection::open(listen(), {}, retry);
    EXPECT_TRUE(connection.ok()) << connection.status();
    return *connection;
  }

  grpc::Status ListJobs(grpc::ServerContext* /*context*/,
                        const v1::ListJobsRequest* /*request*/,
                        v1::ListJobsResponse* /*response*/) override {
    return grpc::Status::OK;
  }
  grpc::Status GetJob(grpc::ServerContext* /*context*/,
                      const v1::GetJobRequest* request,
                      v1::Job* response) override {
    return to_grpc(get(++gets_, request->name(), *response));
  }
  grpc::Status WatchJobs(grpc::ServerContext* context,
                         const v1::WatchJobsRequest* /*request*/,
                         grpc::ServerWriter<v1::JobEvent>* writer) override {
    if (begins_watches) context->AddInitialMetadata(kWatchBegun, "1");
    writer->SendInitialMetadata();
    return to_grpc(watch(++watches_, [&](const v1::JobEvent& event) { writer->Write(event); }));
  }

  int watches() const { return watches_; }

 private:
  std::atomic<int> gets_{0}, watches_{0};
  std::unique_ptr<grpc::Server> server_;
};

}  // namespace tet::test
