// JobService: jobs are made, looked at, stopped, and read.
#pragma once

#include "server/jobs/service/job_context.h"
#include "tetstream/v1/jobs.grpc.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

/// The generated service, but ReadJobResult in bytes: ChunkStream writes its messages itself.
using RawJobService = v1::JobService::WithCallbackMethod_CreateJob<
    v1::JobService::WithCallbackMethod_GetJob<v1::JobService::WithCallbackMethod_ListJobs<
        v1::JobService::WithCallbackMethod_WatchJobs<v1::JobService::WithCallbackMethod_WaitJob<
            v1::JobService::WithCallbackMethod_CancelJob<
                v1::JobService::WithCallbackMethod_RetryJob<
                    v1::JobService::WithCallbackMethod_DeleteJob<
                        v1::JobService::WithCallbackMethod_ListDeadShards<
                            v1::JobService::WithCallbackMethod_ListWorkers<
                                v1::JobService::WithRawCallbackMethod_ReadJobResult<
                                    v1::JobService::Service>>>>>>>>>>>;

/// gRPC's side of the jobs. Thread-safe. All that asks the job store runs on the context's
/// threads. What it refers to outlives the service and its calls.
class JobService final : public RawJobService {
 public:
  JobService(JobContext& shared, GridStore& grids) : shared_(shared), grids_(grids) {}

  grpc::ServerUnaryReactor* CreateJob(grpc::CallbackServerContext* context,
                                      const v1::CreateJobRequest* request,
                                      v1::Job* response) override;
  grpc::ServerUnaryReactor* GetJob(grpc::CallbackServerContext* context,
                                   const v1::GetJobRequest* request,
                                   v1::Job* response) override;
  grpc::ServerUnaryReactor* ListJobs(grpc::CallbackServerContext* context,
                                     const v1::ListJobsRequest* request,
                                     v1::ListJobsResponse* response) override;
  grpc::ServerWriteReactor<v1::JobEvent>* WatchJobs(
      grpc::CallbackServerContext* context, const v1::WatchJobsRequest* request) override;
  grpc::ServerUnaryReactor* WaitJob(grpc::CallbackServerContext* context,
                                    const v1::WaitJobRequest* request,
                                    v1::Job* response) override;
  grpc::ServerUnaryReactor* CancelJob(grpc::CallbackServerContext* context,
                                      const v1::CancelJobRequest* request,
                                      v1::Job* response) override;
  grpc::ServerUnaryReactor* RetryJob(grpc::CallbackServerContext* context,
                                     const v1::RetryJobRequest* request,
                                     v1::Job* response) override;
  grpc::ServerUnaryReactor* DeleteJob(grpc::CallbackServerContext* context,
                                      const v1::DeleteJobRequest* request,
                                      google::protobuf::Empty* response) override;
  grpc::ServerUnaryReactor* ListDeadShards(grpc::CallbackServerContext* context,
                                           const v1::ListDeadShardsRequest* request,
                                           v1::ListDeadShardsResponse* response) override;
  grpc::ServerUnaryReactor* ListWorkers(grpc::CallbackServerContext* context,
                                        const v1::ListWorkersRequest* request,
                                        v1::ListWorkersResponse* response) override;
  grpc::ServerWriteReactor<grpc::ByteBuffer>* ReadJobResult(
      grpc::CallbackServerContext* context, const grpc::ByteBuffer* request) override;

 private:
  JobContext& shared_;
  GridStore& grids_;
};

}  // namespace tet
