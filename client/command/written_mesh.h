// A mesh that goes to its file while it is made.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "client/command/mesh_maker.h"
#include "client/command/mesh_options.h"
#include "core/base/cancel.h"
#include "core/files/parts_file.h"
#include "core/plan/make/mesher.h"

namespace tet {

/// The file of a mesh, where it can be written part by part and nothing else needs the mesh
/// afterwards: neither a report, nor middle nodes, nor what is said of labels and faces.
class WrittenMesh {
 public:
  /// `cancellation` outlives this.
  WrittenMesh(const MeshOptions& options, const Cancellation& cancellation)
      : options_(options), cancellation_(cancellation) {}

  /// Makes the file for a mesh of this header; see ChooseTaker.
  absl::StatusOr<TakePart> choose_taker(const MeshHeader& header);

  /// Whether somebody took the mesh.
  bool is_begun() const noexcept { return file_.has_value(); }
  /// Gives the file its name, and says so in `made`.
  absl::Status finish(MadeMesh& made);

 private:
  absl::Status take(const TetMesh& part, const ChunkExtent& place);

  const MeshOptions& options_;
  const Cancellation& cancellation_;
  std::optional<PartsFile> file_;
  std::atomic<std::uint64_t> tets_inside_{0};
};

}  // namespace tet
