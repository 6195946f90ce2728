#include "core/files/block_writer.h"

namespace tet {

BlockWriter::BlockWriter(AtomicFile& file,
                         std::uint64_t total_bytes,
                         const WriteControl& control)
    : file_(file), total_bytes_(total_bytes), control_(control), block_(kBlockBytes) {}

void BlockWriter::bytes(std::span<const std::byte> column) {
  while (!column.empty() && status_.ok()) {
    const std::size_t size = std::min(column.size(), kBlockBytes);
    write_block(column.first(size));
    column = column.subspan(size);
  }
}

void BlockWriter::move_to(std::uint64_t offset) {
  if (status_.ok()) file_.move_to(offset);
}

void BlockWriter::write_block(std::span<const std::byte> block, std::uint64_t progress_bytes) {
  if (!status_.ok()) return;
  if (control_.cancellation && control_.cancellation->requested()) {
    status_ = absl::CancelledError("stopped while writing the mesh");
    return;
  }
  status_ = file_.write(block);
  written_bytes_ += progress_bytes;
  if (control_.progress && total_bytes_ > 0) {
    control_.progress(static_cast<double>(written_bytes_) / static_cast<double>(total_bytes_));
  }
}

}  // namespace tet
