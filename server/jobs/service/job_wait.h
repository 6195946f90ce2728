// One WaitJob call.
#pragma once

#include <memory>
#include <mutex>
#include <string>

#include <absl/status/status.h>
#include <grpcpp/alarm.h>
#include <grpcpp/support/server_callback.h>

#include "server/jobs/service/job_context.h"
#include "server/rpc/calls.h"
#include "tetstream/v1/jobs.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

/// Looks at the job when it is told of news, and when its time is up. Lives until gRPC is done
/// with it and the last task that refers to it has run.
class JobWait final : public grpc::ServerUnaryReactor,
                      public std::enable_shared_from_this<JobWait> {
 public:
  /// Begins the call; what it returns is for gRPC.
  static grpc::ServerUnaryReactor* start(JobContext& shared,
                                         grpc::CallbackServerContext& context,
                                         const v1::WaitJobRequest& request,
                                         v1::Job& response);

 private:
  JobWait(JobContext& shared, grpc::CallbackServerContext& context, v1::Job& response)
      : shared_(shared),
        context_(context),
        call_(shared.engine.calls, context, "WaitJob"),
        response_(response) {}

  void OnCancel() override;
  void OnDone() override;

  void begin(const v1::WaitJobRequest& request);
  void wait(absl::Duration timeout);
  void time_is_up();
  void look_soon();
  void look();
  void answer(const absl::Status& status, const Job& job);
  void answer_failure(const absl::Status& status);

  JobContext& shared_;
  grpc::CallbackServerContext& context_;  ///< there until gRPC is done
  Call call_;
  v1::Job& response_;
  std::string name_;
  std::shared_ptr<JobWait> self_;  ///< until gRPC is done

  std::mutex mutex_;  ///< guards all below
  std::unique_ptr<JobNotifier::Subscription> subscription_;
  std::unique_ptr<grpc::Alarm> timer_;
  bool looking_ = false, look_again_ = false;
  bool time_is_up_ = false;
  bool answered_ = false;
};

}  // namespace tet
