// MeshService: capabilities, estimates and streams.
#pragma once

#include "server/mesh_engine.h"
#include "tetstream/v1/meshes.grpc.pb.h"

namespace tet {

/// gRPC's side of the mesher. Thread-safe; the engine outlives it.
class MeshService final : public v1::MeshService::CallbackService {
 public:
  explicit MeshService(MeshEngine& engine) : engine_(engine) {}

  grpc::ServerUnaryReactor* GetCapabilities(grpc::CallbackServerContext* context,
                                            const v1::GetCapabilitiesRequest* request,
                                            v1::Capabilities* response) override;
  grpc::ServerUnaryReactor* EstimateMesh(grpc::CallbackServerContext* context,
                                         const v1::EstimateMeshRequest* request,
                                         v1::MeshHeader* response) override;
  grpc::ServerWriteReactor<v1::MeshEvent>* StreamMesh(
      grpc::CallbackServerContext* context, const v1::StreamMeshRequest* request) override;

 private:
  MeshEngine& engine_;
};

}  // namespace tet
