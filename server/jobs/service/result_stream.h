// One ReadJobResult call: a mesh sent from where a job stored it.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "server/jobs/results/job_spec.h"
#include "server/jobs/service/job_context.h"
#include "server/streams/chunk_stream.h"
#include "tetstream/v1/jobs.pb.h"

namespace tet {

/// Chunks are read and verified as they are sent.
class ResultStream final : public ChunkStream {
 public:
  /// Begins the call; what it returns is for gRPC.
  static grpc::ServerWriteReactor<grpc::ByteBuffer>* start(JobContext& shared,
                                                           grpc::CallbackServerContext& context,
                                                           const grpc::ByteBuffer& request);

 private:
  ResultStream(JobContext& shared, grpc::CallbackServerContext& context)
      : ChunkStream(shared.engine, context, "ReadJobResult"), shared_(shared) {}

  void admitted() override;
  void open() override;
  std::uint64_t chunk_count() const override;
  v1::MeshEvent header() const override;
  absl::StatusOr<ChunkMessage> make(std::uint64_t index, Block block) override;
  v1::MeshEvent trailer(std::uint64_t first,
                        std::uint64_t end,
                        const QualityStats& quality) const override;

  absl::Status find_result();
  absl::StatusOr<ChunkDigest> digest_of_chunk(std::int64_t index);

  std::shared_ptr<ResultStream> self() {
    return std::static_pointer_cast<ResultStream>(shared_from_this());
  }

  JobContext& shared_;
  v1::ReadJobResultRequest request_;
  // Only the task that opens touches these until there are chunks.
  std::string id_;
  stored::JobPlan plan_;
  std::shared_ptr<MeshFolder> folder_;

  std::mutex digests_mutex_;
  std::map<std::int64_t, ChunkDigest> digests_;  ///< the pages that are being sent
};

}  // namespace tet
