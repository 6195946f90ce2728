// A mesh that comes in compact chunks.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/base/quality_stats.h"
#include "core/mesh/tet_mesh.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

struct FilledMesh;

/// Gathers compact chunks, and makes the mesh of them when they are all there. Not thread-safe.
class CompactReceiver {
 public:
  /// Errors: kDataLoss (a header that no compact mesh has).
  static absl::StatusOr<CompactReceiver> begin(const v1::MeshHeader& header);

  ~CompactReceiver();
  CompactReceiver(CompactReceiver&&) noexcept;
  CompactReceiver& operator=(CompactReceiver&&) noexcept;

  /// The next chunk. Errors: kDataLoss.
  absl::Status add(std::span<const std::byte> chunk);

  /// Makes the mesh on every core, in the memory of `used`. Errors: those of decode_mesh.
  absl::StatusOr<FilledMesh> finish(const MeshHeader& header,
                                    const Cancellation& cancellation,
                                    TetMesh used,
                                    Statistics statistics) &&;

 private:
  struct Parts;
  explicit CompactReceiver(std::unique_ptr<Parts> parts) noexcept;

  std::unique_ptr<Parts> parts_;
};

}  // namespace tet
