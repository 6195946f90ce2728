// GridService: uploads, and what is stored.
#pragma once

#include <cstdint>

#include "core/base/parallel.h"
#include "core/vdb/decoder/decoder_pool.h"
#include "server/grids/grid_store.h"
#include "server/rpc/calls.h"
#include "server/rpc/fair_tasks.h"
#include "server/rpc/stall_watch.h"
#include "tetstream/v1/grids.grpc.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

/// The generated service, but UploadGrid in bytes: UploadStream reads its messages itself.
using RawUploadService = v1::GridService::WithCallbackMethod_FindMissingGrids<
    v1::GridService::WithRawCallbackMethod_UploadGrid<
        v1::GridService::WithCallbackMethod_GetUploadStatus<
            v1::GridService::WithCallbackMethod_ListGrids<
                v1::GridService::WithCallbackMethod_GetGridInfo<v1::GridService::Service>>>>>;

/// gRPC's side of the store. Thread-safe. Disk work runs on `disk`, threads of its own, so that
/// uploads do not wait for meshes, and nobody's for all of another's; files are read by
/// `decoders`, of a grid no more than `resident_bytes`. The store and the others outlive the
/// service and its calls.
class GridService final : public RawUploadService {
 public:
  GridService(GridStore& store,
              CallRegistry& calls,
              FairTasks& disk,
              DecoderPool& decoders,
              StallWatch& stalls,
              std::uint64_t resident_bytes)
      : store_(store),
        calls_(calls),
        disk_(disk),
        decoders_(decoders),
        stalls_(stalls),
        resident_bytes_(resident_bytes) {}

  grpc::ServerUnaryReactor* FindMissingGrids(grpc::CallbackServerContext* context,
                                             const v1::FindMissingGridsRequest* request,
                                             v1::FindMissingGridsResponse* response) override;
  grpc::ServerReadReactor<grpc::ByteBuffer>* UploadGrid(grpc::CallbackServerContext* context,
                                                        grpc::ByteBuffer* response) override;
  grpc::ServerUnaryReactor* GetUploadStatus(grpc::CallbackServerContext* context,
                                            const v1::GetUploadStatusRequest* request,
                                            v1::UploadStatus* response) override;
  grpc::ServerUnaryReactor* ListGrids(grpc::CallbackServerContext* context,
                                      const v1::ListGridsRequest* request,
                                      v1::ListGridsResponse* response) override;
  grpc::ServerUnaryReactor* GetGridInfo(grpc::CallbackServerContext* context,
                                        const v1::GetGridInfoRequest* request,
                                        v1::GridFile* response) override;

 private:
  GridStore& store_;
  CallRegistry& calls_;
  FairTasks& disk_;
  DecoderPool& decoders_;
  StallWatch& stalls_;
  const std::uint64_t resident_bytes_;  // that one grid may take in memory
};

}  // namespace tet
