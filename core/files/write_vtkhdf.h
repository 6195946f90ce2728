// VTK's HDF5 unstructured grid (.vtkhdf), version 1.0.
#pragma once

#include <memory>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/files/block_writer.h"
#include "core/files/file_mesh.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// A mesh that comes in parts, in any order; none of it is kept in memory. The file is the same
/// as if it had come whole. `file` is left for the caller to commit.
class VtkHdfWriter {
 public:
  /// Writes all but the parts, of a mesh of this header and shape. `file` and `control` outlive
  /// the writer. Errors: those of AtomicFile, kResourceExhausted (the disk is full),
  /// kCancelled.
  static absl::StatusOr<VtkHdfWriter> begin(AtomicFile& file,
                                            const MeshHeader& mesh,
                                            const FileShape& shape,
                                            const WriteControl& control);
  VtkHdfWriter(VtkHdfWriter&&) noexcept;
  ~VtkHdfWriter();

  /// Writes vertices and tets (with the ids of the whole mesh) to their place in it. A mesh of
  /// second order is one part.
  absl::Status put(const FileMesh& nodes, const ChunkExtent& place);

 private:
  struct Impl;
  explicit VtkHdfWriter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Writes the whole mesh as one part, regions as `CellData/region` and fields in `PointData`;
/// `file` is left for the caller to commit.
///
/// HDF5 lays the file out and makes its few small parts, in memory; the large columns go
/// straight to their places, so that a full disk or a Ctrl-C ends in our own error and not
/// inside HDF5.
absl::Status write_vtkhdf(AtomicFile& file, const FileMesh& mesh, const WriteControl& control);

}  // namespace tet
