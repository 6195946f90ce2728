// One WatchJobs call.
#pragma once

#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include <absl/status/status.h>
#include <grpcpp/support/server_callback.h>

#include "server/jobs/service/job_context.h"
#include "server/rpc/calls.h"
#include "server/rpc/stall_watch.h"
#include "tetstream/v1/jobs.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

/// Reads a page of events, writes them, reads on; waits for news where there are none. Holds
/// one page however slowly its client reads.
///
/// Lives until gRPC is done with it and the last task that refers to it has run.
class JobWatch final : public grpc::ServerWriteReactor<v1::JobEvent>,
                       public Stallable,
                       public std::enable_shared_from_this<JobWatch> {
 public:
  /// Begins the call; what it returns is for gRPC.
  static grpc::ServerWriteReactor<v1::JobEvent>* start(JobContext& shared,
                                                       grpc::CallbackServerContext& context,
                                                       const v1::WatchJobsRequest& request);

 private:
  enum class Step { kWait, kRead, kWrite, kFinish };

  JobWatch(JobContext& shared, grpc::CallbackServerContext& context);

  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override;
  std::optional<Stallable::Clock::time_point> waiting_since() override;
  void give_up(std::chrono::seconds waited) override;

  void begin(const v1::WatchJobsRequest& request);
  absl::Status find_job(const std::string& name);
  void subscribe();
  void news();
  void read();
  absl::StatusOr<EventPage> read_page();
  void advance();
  Step next_step();
  void end(const absl::Status& status);
  void end_from_outside(const absl::Status& status);

  JobContext& shared_;
  grpc::CallbackServerContext& context_;  ///< there until gRPC is done
  Call call_;
  std::shared_ptr<JobWatch> self_;  ///< until gRPC is done
  WatchJobs query_;                 ///< of the task that reads

  std::mutex mutex_;  ///< guards all below
  std::unique_ptr<JobNotifier::Subscription> subscription_;
  std::deque<JobEvent> events_;
  v1::JobEvent outgoing_;
  bool news_ = true;  ///< there may be more to read
  bool reading_ = false;
  bool writing_ = false;
  bool deleted_ = false;     ///< no event comes after the last of `events_`
  bool cancelling_ = false;  ///< the call may not finish now
  bool ended_ = false, finished_ = false;
  Stallable::Clock::time_point write_start_{};
  std::int64_t written_ = 0;
  absl::Status status_;
};

}  // namespace tet
