// MeshService: capabilities, estimates, streams and points.
#pragma once

#include "server/streams/mesh_engine.h"
#include "tetstream/v1/meshes.grpc.pb.h"

namespace tet {

/// The generated service, but its streams in bytes: ChunkStream writes its messages itself.
using RawStreamService = v1::MeshService::WithCallbackMethod_GetCapabilities<
    v1::MeshService::WithCallbackMethod_EstimateMesh<
        v1::MeshService::WithRawCallbackMethod_StreamMesh<
            v1::MeshService::WithRawCallbackMethod_RemeshSession<
                v1::MeshService::WithRawCallbackMethod_SamplePoints<
                    v1::MeshService::Service>>>>>;

/// gRPC's side of the mesher. Thread-safe; the engine outlives it.
class MeshService final : public RawStreamService {
 public:
  explicit MeshService(MeshEngine& engine) : engine_(engine) {}

  grpc::ServerUnaryReactor* GetCapabilities(grpc::CallbackServerContext* context,
                                            const v1::GetCapabilitiesRequest* request,
                                            v1::Capabilities* response) override;
  grpc::ServerUnaryReactor* EstimateMesh(grpc::CallbackServerContext* context,
                                         const v1::EstimateMeshRequest* request,
                                         v1::MeshHeader* response) override;
  grpc::ServerWriteReactor<grpc::ByteBuffer>* StreamMesh(
      grpc::CallbackServerContext* context, const grpc::ByteBuffer* request) override;
  grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>* RemeshSession(
      grpc::CallbackServerContext* context) override;
  grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>* SamplePoints(
      grpc::CallbackServerContext* context) override;

 private:
  MeshEngine& engine_;
};

}  // namespace tet
