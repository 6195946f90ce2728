#include "core/files/parts_file.h"

#include <utility>

#include "core/files/block_writer.h"
#include "core/files/mesh_columns.h"
#include "core/files/write_vtkhdf.h"
#include "core/files/write_vtu.h"

namespace tet {

struct PartsFile::Impl {
  AtomicFile file;
  WriteControl control;
  BlockWriter writer;  ///< of both
  FileColumns columns = {};

  Impl(AtomicFile to, const Cancellation& cancellation)
      : file(std::move(to)),
        control{.cancellation = &cancellation, .progress = {}},
        writer(file, 0, control) {}
};

PartsFile::PartsFile(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PartsFile::PartsFile(PartsFile&&) noexcept = default;
PartsFile::~PartsFile() = default;

bool PartsFile::has_format(MeshFormat format) noexcept {
  return format == MeshFormat::kVtu || format == MeshFormat::kVtkHdf;
}

absl::StatusOr<PartsFile> PartsFile::create(const MeshOutput& output,
                                            const MeshHeader& mesh,
                                            const Cancellation& cancellation) {
  absl::StatusOr<AtomicFile> file = AtomicFile::create(output.path);
  if (!file.ok()) return file.status();
  auto impl = std::make_unique<Impl>(*std::move(file), cancellation);
  const FileShape shape = shape_of(mesh);
  if (output.format == MeshFormat::kVtkHdf) {
    auto columns = begin_vtkhdf(impl->file, impl->writer, mesh, shape);
    if (!columns.ok()) return columns.status();
    impl->columns = *std::move(columns);
  } else {
    impl->columns = begin_vtu(impl->writer, mesh, shape);
  }
  if (!impl->writer.status().ok()) return impl->writer.status();
  return PartsFile(std::move(impl));
}

absl::Status PartsFile::put(const TetMesh& part, const ChunkExtent& place) const {
  BlockWriter writer = impl_->writer.another();
  write_columns(writer, impl_->columns, {part}, place);
  return writer.status();
}

absl::Status PartsFile::commit() { return impl_->file.commit(); }

}  // namespace tet
