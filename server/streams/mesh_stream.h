// One StreamMesh call: a mesh sent while it is made.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "core/fidelity/fidelity.h"
#include "server/jobs/results/stored_mesh.h"
#include "server/streams/chunk_stream.h"

namespace tet {

/// Plans the mesh, and says how far that is; then its chunks are made as they are sent, those
/// of a patch where the client has a mesh that parts can be kept of. Where a job has made the
/// mesh before, its chunks are sent from where they are stored.
class MeshStream final : public ChunkStream {
 public:
  /// Begins the call; what it returns is for gRPC.
  static grpc::ServerWriteReactor<grpc::ByteBuffer>* start(MeshEngine& engine,
                                                           grpc::CallbackServerContext& context,
                                                           const grpc::ByteBuffer& request);

 private:
  MeshStream(MeshEngine& engine, grpc::CallbackServerContext& context)
      : ChunkStream(engine, context, "StreamMesh") {}

  void admitted() override;
  void open() override;
  void note_opening() override;
  std::uint64_t chunk_count() const override;
  v1::MeshEvent header() const override;
  absl::StatusOr<ChunkMessage> make(std::uint64_t index, Block block) override;
  v1::MeshEvent trailer(std::uint64_t first,
                        std::uint64_t end,
                        const QualityStats& quality) const override;
  std::function<absl::Status()> work_for_trailer() override;
  absl::Status check_shareable() const override;

  bool find_stored();
  void plan();
  absl::Status reserve_for_fidelity();
  void plan_mesh();
  bool gives_up_base(const absl::Status& failure);
  void find_patches();
  const std::string& mesh_id() const;
  absl::Status check_mesh() const;
  absl::StatusOr<ChunkMessage> read(std::uint64_t index, Block block);
  void begin(const absl::Status& planned);

  std::shared_ptr<MeshStream> self() {
    return std::static_pointer_cast<MeshStream>(shared_from_this());
  }

  StreamOrder order_;
  // Only the task that plans touches these until there are chunks.
  std::shared_ptr<const StoredMesh> stored_;  ///< null: the chunks are made
  std::shared_ptr<const MeshPlan> base_;      ///< null: the mesh is sent whole
  PlannedMesh planned_;
  ChunkSource source_;
  std::shared_ptr<const void> reserved_;  ///< memory for measuring
  std::optional<MeshFidelity> fidelity_;  ///< once it is measured: before the trailer
};

}  // namespace tet
