#include "core/files/parts_file.h"

#include <functional>
#include <utility>

#include "core/files/block_writer.h"
#include "core/files/mesh_columns.h"
#include "core/files/write_msh.h"
#include "core/files/write_vtkhdf.h"
#include "core/files/write_vtu.h"

namespace tet {
namespace {

/// Writes the rows of a part to their places in a file.
using WriteRows =
    std::function<void(BlockWriter& writer, const TetMesh& part, const ChunkExtent& place)>;

WriteRows rows_of(FileColumns columns) {
  return [columns = std::move(columns)](BlockWriter& writer, const TetMesh& part,
                                        const ChunkExtent& place) {
    write_columns(writer, columns, {part}, place);
  };
}

WriteRows rows_of(MshColumns columns) {
  return [columns = std::move(columns)](BlockWriter& writer, const TetMesh& part,
                                        const ChunkExtent& place) {
    write_msh_part(writer, columns, part, place);
  };
}

template <class Columns>
absl::StatusOr<WriteRows> rows_of(absl::StatusOr<Columns> columns) {
  if (!columns.ok()) return columns.status();
  return rows_of(*std::move(columns));
}

/// Writes all of a file but the rows of parts.
absl::StatusOr<WriteRows> begin(MeshFormat format,
                                const MeshHeader& mesh,
                                AtomicFile& file,
                                BlockWriter& writer) {
  const FileShape shape = shape_of(mesh);
  if (format == MeshFormat::kMsh) return rows_of(begin_msh_of_parts(writer, mesh));
  if (format == MeshFormat::kVtkHdf) return rows_of(begin_vtkhdf(file, writer, mesh, shape));
  return rows_of(begin_vtu(writer, mesh, shape));
}

}  // namespace

struct PartsFile::Impl {
  AtomicFile file;
  WriteControl control;
  BlockWriter writer;  ///< of both
  WriteRows write_rows = {};

  Impl(AtomicFile to, const Cancellation& cancellation)
      : file(std::move(to)),
        control{.cancellation = &cancellation, .progress = {}},
        writer(file, 0, control) {}
};

PartsFile::PartsFile(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PartsFile::PartsFile(PartsFile&&) noexcept = default;
PartsFile::~PartsFile() = default;

bool PartsFile::takes(MeshFormat format, const MeshHeader& mesh) noexcept {
  if (format == MeshFormat::kMsh) return msh_takes_parts(mesh);
  return format == MeshFormat::kVtu || format == MeshFormat::kVtkHdf;
}

absl::StatusOr<PartsFile> PartsFile::create(const MeshOutput& output,
                                            const MeshHeader& mesh,
                                            const Cancellation& cancellation) {
  absl::StatusOr<AtomicFile> file = AtomicFile::create(output.path);
  if (!file.ok()) return file.status();
  auto impl = std::make_unique<Impl>(*std::move(file), cancellation);
  auto rows = begin(output.format, mesh, impl->file, impl->writer);
  if (!rows.ok()) return rows.status();
  impl->write_rows = *std::move(rows);
  if (!impl->writer.status().ok()) return impl->writer.status();
  return PartsFile(std::move(impl));
}

absl::Status PartsFile::put(const TetMesh& part, const ChunkExtent& place) const {
  BlockWriter writer = impl_->writer.another();
  impl_->write_rows(writer, part, place);
  return writer.status();
}

absl::Status PartsFile::commit() { return impl_->file.commit(); }

}  // namespace tet
