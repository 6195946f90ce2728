// The consumer that patches a mesh in place.
#pragma once

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "client/library/chunk_consumer.h"
#include "core/base/parallel.h"
#include "core/mesh/stable/stable_mesh.h"

namespace tet {

/// Writes every chunk to the slots of what it brings.
class StableChunks final : public ChunkConsumer {
 public:
  /// `mesh`, which a header's `kept` is of, outlives this.
  explicit StableChunks(StableMesh& mesh) : mesh_(&mesh) {}

  absl::Status make_room(const MeshHeader& header, const KeptParts* kept) override {
    absl::Status begun;
    TaskPool pool;
    pool.run([&] { begun = mesh_->begin(header, kept); });
    return begun;
  }
  absl::StatusOr<ChunkColumns> place(const ChunkExtent& chunk) override {
    return mesh_->place(chunk);
  }
  absl::Status take(const ChunkExtent& chunk) override { return mesh_->take(chunk); }

 private:
  StableMesh* mesh_;
};

}  // namespace tet
