// One call of each method that there is, for tests of who may make it.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/support/status.h>

#include "grpc/health/v1/health.grpc.pb.h"
#include "tetstream/v1/grids.grpc.pb.h"
#include "tetstream/v1/jobs.grpc.pb.h"
#include "tetstream/v1/meshes.grpc.pb.h"

namespace tet::test {

namespace v1 = ::tetstream::v1;

struct EveryCall {
  using Make =
      std::function<grpc::Status(const std::shared_ptr<grpc::Channel>&, grpc::ClientContext&)>;
  std::string method;
  std::string scope;  ///< that it needs; empty: any token will do
  Make make;
  std::string reason = {};  ///< how it ends where it is allowed; empty: well
};

namespace every_call {

/// A unary method whose answer does not matter.
template <class Service, class Request, class Response>
EveryCall::Make unary(grpc::Status (Service::Stub::*method)(grpc::ClientContext*,
                                                            const Request&,
                                                            Response*),
                      Request request) {
  return [method, request](const auto& channel, grpc::ClientContext& context) {
    typename Service::Stub stub(channel);
    Response response;
    return (stub.*method)(&context, request, &response);
  };
}

inline EveryCall::Make upload(const std::string& name) {
  return [name](const auto& channel, grpc::ClientContext& context) {
    v1::GridService::Stub stub(channel);
    v1::UploadGridResponse response;
    const auto writer = stub.UploadGrid(&context, &response);
    v1::UploadGridRequest message;
    message.mutable_start()->set_name(name);
    message.mutable_start()->set_size_bytes(1);
    writer->Write(message);
    writer->WritesDone();
    return writer->Finish();
  };
}

/// A session of one frame.
inline EveryCall::Make session(const v1::MeshRequest& mesh) {
  return [mesh](const auto& channel, grpc::ClientContext& context) {
    v1::MeshService::Stub stub(channel);
    const auto stream = stub.RemeshSession(&context);
    v1::RemeshRequest message;
    *message.mutable_start() = mesh;
    stream->Write(message);
    stream->WritesDone();
    for (v1::MeshEvent event; stream->Read(&event);) {
    }
    return stream->Finish();
  };
}

/// Points of which there is one.
inline EveryCall::Make samples(const v1::MeshRequest& mesh) {
  return [mesh](const auto& channel, grpc::ClientContext& context) {
    v1::MeshService::Stub stub(channel);
    const auto stream = stub.SamplePoints(&context);
    v1::SamplePointsRequest start, points;
    *start.mutable_start() = mesh;
    points.mutable_points()->set_positions(std::string(3 * sizeof(double), '\0'));
    stream->Write(start);
    stream->Write(points);
    stream->WritesDone();
    for (v1::SamplePointsResponse response; stream->Read(&response);) {
    }
    return stream->Finish();
  };
}

/// A stream of one service's that is read to its end.
template <class Service, class Request, class Event>
EveryCall::Make reader(std::unique_ptr<grpc::ClientReader<Event>> (Service::Stub::*method)(
                           grpc::ClientContext*, const Request&),
                       Request request) {
  return [method, request](const auto& channel, grpc::ClientContext& context) {
    typename Service::Stub stub(channel);
    const auto events = (stub.*method)(&context, request);
    for (Event event; events->Read(&event);) {
    }
    return events->Finish();
  };
}

/// About a job that there is not.
inline void add_job_calls(const v1::MeshRequest& mesh, std::vector<EveryCall>& calls) {
  using v1::JobService;
  const std::string read = "\"jobs.read\"", write = "\"jobs.write\"";
  const std::string unknown = "tetstream/JOB_NOT_FOUND";
  const auto about_none = [](auto request) {
    request.set_name("jobs/" + std::string(24, '0'));
    return request;
  };
  v1::CreateJobRequest create;
  *create.mutable_job()->mutable_mesh() = mesh;
  calls.push_back(
      {"CreateJob", write, unary<JobService>(&JobService::Stub::CreateJob, create)});
  calls.push_back({"ListJobs", read,
                   unary<JobService>(&JobService::Stub::ListJobs, v1::ListJobsRequest())});
  const auto add = [&](const char* method, const std::string& scope, auto stub_method,
                       auto request) {
    calls.push_back(
        {method, scope, unary<JobService>(stub_method, about_none(request)), unknown});
  };
  add("GetJob", read, &JobService::Stub::GetJob, v1::GetJobRequest());
  add("WaitJob", read, &JobService::Stub::WaitJob, v1::WaitJobRequest());
  add("CancelJob", write, &JobService::Stub::CancelJob, v1::CancelJobRequest());
  add("RetryJob", write, &JobService::Stub::RetryJob, v1::RetryJobRequest());
  add("DeleteJob", write, &JobService::Stub::DeleteJob, v1::DeleteJobRequest());
  calls.push_back(
      {"ListWorkers", "\"workers.read\"",
       unary<JobService>(&JobService::Stub::ListWorkers, v1::ListWorkersRequest())});
  add("ListDeadShards", read, &JobService::Stub::ListDeadShards, v1::ListDeadShardsRequest());
  calls.push_back(
      {"WatchJobs", read,
       reader<JobService>(&JobService::Stub::WatchJobs, about_none(v1::WatchJobsRequest())),
       unknown});
  calls.push_back({"ReadJobResult", read,
                   reader<JobService>(&JobService::Stub::ReadJobResult,
                                      about_none(v1::ReadJobResultRequest())),
                   unknown});
}

}  // namespace every_call

/// All methods of all services, about the grid file `name`.
inline std::vector<EveryCall> every_call_about(const std::string& name) {
  using v1::GridService;
  using v1::MeshService;
  v1::FindMissingGridsRequest find;
  find.add_names(name);
  v1::GetUploadStatusRequest status;
  status.set_name(name);
  v1::GetGridInfoRequest info;
  info.set_name(name);
  v1::MeshRequest mesh;
  mesh.set_name(name);
  v1::EstimateMeshRequest estimate;
  *estimate.mutable_mesh() = mesh;
  using every_call::unary;
  const std::string read = "\"grids.read\"";
  std::vector<EveryCall> calls;
  calls.push_back({"FindMissingGrids", read,
                   unary<GridService>(&GridService::Stub::FindMissingGrids, find)});
  calls.push_back({"GetUploadStatus", read,
                   unary<GridService>(&GridService::Stub::GetUploadStatus, status)});
  calls.push_back({"ListGrids", read,
                   unary<GridService>(&GridService::Stub::ListGrids, v1::ListGridsRequest())});
  calls.push_back(
      {"GetGridInfo", read, unary<GridService>(&GridService::Stub::GetGridInfo, info)});
  calls.push_back({"UploadGrid", "\"grids.write\"", every_call::upload(name)});
  calls.push_back({"EstimateMesh", "\"mesh\"",
                   unary<MeshService>(&MeshService::Stub::EstimateMesh, estimate)});
  calls.push_back({"RemeshSession", "\"mesh\"", every_call::session(mesh)});
  calls.push_back({"SamplePoints", "\"mesh\"", every_call::samples(mesh)});
  v1::StreamMeshRequest stream;
  *stream.mutable_mesh() = mesh;
  calls.push_back({"StreamMesh", "\"mesh\"",
                   every_call::reader<MeshService>(&MeshService::Stub::StreamMesh, stream)});
  calls.push_back(
      {"GetCapabilities", "",
       unary<MeshService>(&MeshService::Stub::GetCapabilities, v1::GetCapabilitiesRequest())});
  every_call::add_job_calls(mesh, calls);
  return calls;
}

}  // namespace tet::test
