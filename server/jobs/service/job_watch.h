// One WatchJobs call.
#pragma once

#include <deque>
#include <memory>
#include <string>

#include <absl/status/status.h>
#include <grpcpp/support/server_callback.h>

#include "server/jobs/service/job_context.h"
#include "server/rpc/stream_writer.h"
#include "tetstream/v1/jobs.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

/// Reads a page of events, writes them, reads on; waits for news where there are none. Holds
/// one page however slowly its client reads.
class JobWatch final : public grpc::ServerWriteReactor<v1::JobEvent>, public StreamWriter {
 public:
  /// Begins the call; what it returns is for gRPC.
  static grpc::ServerWriteReactor<v1::JobEvent>* start(JobContext& shared,
                                                       grpc::CallbackServerContext& context,
                                                       const v1::WatchJobsRequest& request);

 private:
  JobWatch(JobContext& shared, grpc::CallbackServerContext& context);

  void OnWriteDone(bool ok) override { written(ok); }
  void OnCancel() override { cancelled(); }
  void OnDone() override;

  bool prepare() override;
  bool after_write() override;
  void note_finish() override { call_.note("events", written_); }
  void write() override { StartWrite(&outgoing_); }
  void finish(const grpc::Status& status) override { Finish(status); }

  void begin(const v1::WatchJobsRequest& request);
  absl::Status find_job(const std::string& name);
  void tell_beginning();
  void subscribe();
  void news();
  void read();

  std::shared_ptr<JobWatch> self() {
    return std::static_pointer_cast<JobWatch>(shared_from_this());
  }

  JobContext& shared_;
  std::shared_ptr<JobWatch> kept_;  ///< until gRPC is done
  WatchJobs query_;                 ///< of the task that reads
  bool counted_ = false;            ///< among the client's watches

  // The writer's lock guards all below.
  std::unique_ptr<JobNotifier::Subscription> subscription_;
  std::deque<JobEvent> events_;
  v1::JobEvent outgoing_;
  bool news_ = true;  ///< there may be more to read
  bool reading_ = false;
  bool deleted_ = false;  ///< no event comes after the last of `events_`
  bool gone_ = false;     ///< there was no such job to begin with, only events of it
  std::int64_t written_ = 0;
};

}  // namespace tet
