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
#include "tetstream/v1/meshes.grpc.pb.h"

namespace tet::test {

namespace v1 = ::tetstream::v1;

struct EveryCall {
  using Make =
      std::function<grpc::Status(const std::shared_ptr<grpc::Channel>&, grpc::ClientContext&)>;
  std::string method;
  std::string scope;  ///< that it needs; empty: any token will do
  Make make;
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

inline EveryCall::Make stream(const v1::MeshRequest& mesh) {
  return [mesh](const auto& channel, grpc::ClientContext& context) {
    v1::MeshService::Stub stub(channel);
    v1::StreamMeshRequest request;
    *request.mutable_mesh() = mesh;
    const auto reader = stub.StreamMesh(&context, request);
    for (v1::MeshEvent event; reader->Read(&event);) {
    }
    return reader->Finish();
  };
}

}  // namespace every_call

/// All methods of both services, about the grid file `name`.
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
  calls.push_back({"StreamMesh", "\"mesh\"", every_call::stream(mesh)});
  calls.push_back(
      {"GetCapabilities", "",
       unary<MeshService>(&MeshService::Stub::GetCapabilities, v1::GetCapabilitiesRequest())});
  return calls;
}

}  // namespace tet::test
