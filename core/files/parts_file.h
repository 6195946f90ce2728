// A mesh file whose mesh comes in parts, as they are made: the mesh is never in memory.
#pragma once

#include <memory>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/files/mesh_file.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// A mesh of first order that comes in parts, in any order. The file is the same as if it had
/// come whole, and has its name only once it is committed; without that nothing is left of it.
class PartsFile {
 public:
  /// Whether files of this format have a place for each part of such a mesh before the others
  /// are there.
  static bool takes(MeshFormat format, const MeshHeader& mesh) noexcept;

  /// Makes the file as long as it will be, and writes all of it but the parts. The format of
  /// `output` takes the mesh, and `cancellation` outlives the file. Errors: those of
  /// write_mesh_file.
  static absl::StatusOr<PartsFile> create(const MeshOutput& output,
                                          const MeshHeader& mesh,
                                          const Cancellation& cancellation);
  PartsFile(PartsFile&&) noexcept;
  ~PartsFile();

  /// Writes vertices and tets (with the ids of the whole mesh) to their place in it. Any thread
  /// may call this. Errors: kResourceExhausted (the disk is full), kCancelled.
  absl::Status put(const TetMesh& part, const ChunkExtent& place) const;

  /// Gives the file its name. The last call, once all parts are there.
  absl::Status commit();

 private:
  struct Impl;
  explicit PartsFile(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace tet
