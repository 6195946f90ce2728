// A mesh that goes to its file while it is made.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "client/command/arguments/mesh_options.h"
#include "client/command/mesh/mesh_maker.h"
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

  /// Asks for the boundary's faces, where the file counts them before its first node and could
  /// else not be written before all of the mesh is there. They go to the file alone.
  void ask_for_faces(const Shape& shape, MeshRequest& request);

  /// Makes the file for a mesh of this header; see ChooseTaker.
  absl::StatusOr<TakePart> choose_taker(const MeshHeader& header);

  /// Whether somebody took the mesh.
  bool is_begun() const noexcept { return file_.has_value(); }
  /// Gives the file its name, and says so in `made`.
  absl::Status finish(MadeMesh& made);

 private:
  /// Whether something else needs the mesh afterwards.
  bool is_wanted_whole() const noexcept {
    return !options_.report.empty() || options_.order > 1;
  }
  absl::Status take(const TetMesh& part, const ChunkExtent& place);

  const MeshOptions& options_;
  const Cancellation& cancellation_;
  bool faces_are_ours_ = false;  ///< and nobody else's
  std::optional<PartsFile> file_;
  std::atomic<std::uint64_t> tets_inside_{0};
};

}  // namespace tet
